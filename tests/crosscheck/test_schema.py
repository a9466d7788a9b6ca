"""Another program's validator accepts the built-in scenes by the schema that the binary prints."""

import json

import jsonschema
import pytest

from scenes import CUBE, SEVERAL, SPHERE, TORUS

BUILT_IN = ["sphere", "cube", "lattice", "street", "snapshot"]


@pytest.fixture(scope="module")
def validator(photosurface):
    schema = json.loads(photosurface("schema"))
    kind = jsonschema.validators.validator_for(schema)
    kind.check_schema(schema)
    return kind(schema)


@pytest.mark.parametrize("name", BUILT_IN)
def test_built_in_scenes_fit_the_schema(name, validator, photosurface):
    validator.validate(json.loads(photosurface("example", name)))


def test_the_list_of_built_in_scenes(photosurface):
    listed = photosurface("example").decode()
    for name in BUILT_IN:
        assert name in listed


@pytest.mark.parametrize(
    "scene", [SPHERE, CUBE, TORUS, SEVERAL], ids=["sphere", "cube", "torus", "several"]
)
def test_scenes_that_the_program_takes_fit_the_schema(scene, validator):
    validator.validate(scene)


@pytest.mark.parametrize(
    "wrong",
    [
        {**SPHERE, "observers": {}},
        {"objects": [{"name": "sphere", "shape": {"sphere": {"radius": 1, "colour": "#fff"}}}]},
        {"objects": [{"name": "sphere", "shape": {"sphere": {"radius": "1"}}}]},
        {**SPHERE, "observer": {"position": [1, 2]}},
        {**SPHERE, "observer": {"velocity": {"speed": 0.5, "direction": [1, 0, 0]}}},
    ],
    ids=["unknown key", "unknown key inside", "text for a number", "two coordinates", "unknown speed"],
)
def test_the_schema_refuses_what_the_program_refuses(wrong, validator):
    assert not validator.is_valid(wrong)
