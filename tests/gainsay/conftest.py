"""A project with a written log and its files for viewers, which tests of views and of pictures share."""

import pytest


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    from tests.gainsay.demo_log import demo_root

    return demo_root(tmp_path_factory.mktemp("root"))


@pytest.fixture
def demo_rrd(demo):
    return demo / "results/demo/logs/spiral.rrd"
