from types import SimpleNamespace

import pytest

from gainsay.errors import InputError
from gainsay.tables.rooms import ROOMS, check_rooms


def folder_with(tmp_path, *names):
    for name in names:
        (tmp_path / name).touch()
    return SimpleNamespace(name="smith1999", folder=tmp_path, root=tmp_path.parent)


def test_rooms_their_parts_and_tables_may_stand_in_a_folder(tmp_path):
    names = [f"{room}.py" for room in ROOMS]
    check_rooms(folder_with(tmp_path, *names, "__init__.py", "conditions_arcs.py", "claims.csv", "paper.toml"))


def test_no_room_is_needed(tmp_path):
    check_rooms(folder_with(tmp_path, "__init__.py"))


@pytest.mark.parametrize("name", ["lmis.py", "Plant.py", "plants.py", "plant_.py", "response2.py", "my_plant.py"])
def test_any_other_module_is_refused_with_the_list(tmp_path, name):
    with pytest.raises(InputError) as error:
        check_rooms(folder_with(tmp_path, "plant.py", name))
    assert f"papers/smith1999/{name}" in str(error.value)
    assert "\n" not in str(error.value) and ", ".join(ROOMS) in str(error.value)


def test_a_near_name_is_meant(tmp_path):
    with pytest.raises(InputError, match=r"expected response\.py, perhaps"):
        check_rooms(folder_with(tmp_path, "responses.py"))
