"""Seconds are counted once each, of the innermost part that counts."""

import time

import pytest

from gainsay.bench.meter import Meter, replaced


def busy(seconds):
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


def test_what_is_counted_inside_another_part_is_taken_out_of_it():
    meter = Meter(("outer", "inner"))
    inner = meter.around("inner", busy)

    def work():
        busy(0.02)
        inner(0.03)
        inner(0.03)

    begun = time.process_time()
    meter.around("outer", work)()
    whole = time.process_time() - begun
    assert 0.06 <= meter.seconds["inner"] < whole - 0.02 + 1e-6
    assert sum(meter.seconds.values()) == pytest.approx(whole, abs=5e-3)


def test_a_call_that_raises_is_counted_and_leaves_nothing_open():
    meter = Meter(("outer",))

    def broken():
        busy(0.01)
        raise ValueError

    for _ in range(2):
        with pytest.raises(ValueError):
            meter.around("outer", broken)()
    assert 0.02 <= meter.seconds["outer"] < 0.1


def test_what_is_replaced_comes_back():
    class Owner:
        value = 1

    with pytest.raises(KeyError), replaced([(Owner, "value", 2)]):
        assert Owner.value == 2
        raise KeyError
    assert Owner.value == 1
