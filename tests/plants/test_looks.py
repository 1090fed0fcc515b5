"""Appearance of the machines: results stay bit-identical, and visual parts move with the machine."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import plants
from plants import slide
from plants.base.plant import LOOKS, Array
from plants.looks import cylindrical_robot, rotary_arm, solids
from plants.slide_parameters import SlideParameters

STEPS, DURATION = 20, 0.2


def shown(plant: Any) -> dict[str, Array]:
    """Ground truth of a run with a random command, row by row, and MuJoCo's coordinates."""
    random = np.random.default_rng(3)
    plant.reset(7, DURATION)
    rows = []
    for _ in range(STEPS):
        plant.sense()
        rows.append(np.concatenate([plant.truth(), plant.data.qpos, plant.data.qvel]))
        commands = [
            channel.start + min(channel.maximum, 1e-3) * random.uniform() for channel in plant.commands
        ]
        plant.command(np.array(commands))
        plant.advance(2)
    names = [channel.name for channel in plant.truths]
    columns = np.array(rows).T
    return {**dict(zip(names, columns, strict=False)), "state": columns[len(names) :]}


@pytest.fixture(params=plants.names())
def stepped(request: pytest.FixtureRequest) -> Any:
    return plants.load(request.param)()


def test_a_plant_that_is_stepped_has_nothing_to_look_at(stepped: Any) -> None:
    model = stepped.model
    assert (model.ncam, model.nlight, model.nmesh) == (0, 0, 0)
    # what touches, and nothing else
    touching = {*model.pair_geom1.tolist(), *model.pair_geom2.tolist()}
    assert set(range(model.ngeom)) == touching


def test_what_is_looked_at_changes_no_bit(stepped: Any) -> None:
    before = shown(stepped)
    drawn = stepped.drawn(before)
    assert drawn.model.ngeom > stepped.model.ngeom + 5
    for name in ("nq", "nv", "nu", "na", "npair"):
        assert getattr(drawn.model, name) == getattr(stepped.model, name)
    assert drawn.model.body_mass.sum() == stepped.model.body_mass.sum()
    after = shown(drawn)
    assert {name: column.tobytes() for name, column in after.items()} == {
        name: column.tobytes() for name, column in before.items()
    }


def test_every_machine_has_its_cameras_and_a_light(stepped: Any) -> None:
    model = stepped.drawn(shown(stepped)).model
    assert {model.camera(i).name for i in range(model.ncam)} == {"overview", "closeup"}
    assert model.nlight == 1
    visible = [i for i in range(model.ngeom) if model.geom_group[i] == 2]
    assert not model.geom_contype[visible].any()
    assert not model.geom_conaffinity[visible].any()
    assert (model.geom_matid[visible] >= 0).all()


def test_the_class_of_the_looks_is_in_one_file() -> None:
    (folder,) = plants.__path__
    text = Path(folder, "looks", "workshop.xml").read_text()
    assert f'<default class="{LOOKS}">' in text


def posed(plant: Any, truths: dict[str, Array], row: int) -> Any:
    plant.draw(truths, row, lambda name, value: value)
    mujoco.mj_kinematics(plant.model, plant.data)
    return plant.model


def test_the_burr_is_gone_where_the_tool_went() -> None:
    plain = plants.load("cylindrical_robot")()
    plain.reset(1, 1.0)
    rows = 101
    truths = {
        "distance": np.linspace(0.0, 0.15, rows),
        "deviation": np.full(rows, 1e-3),
        "burr_left": np.full(rows, 1e-7),
    }
    plant = plain.drawn(truths)
    plant.reset(1, 1.0)

    def heights(row: int) -> Array:
        model = posed(plant, truths, row)
        return np.array([2.0 * model.geom(f"burr{i}").size[0] for i in range(160)])

    fresh, cut, again = heights(0), heights(rows - 1), heights(0)
    # the same burr before: 2 to 5 mm, except its gaps
    assert np.array_equal(fresh, again)
    assert fresh.max() <= 5e-3
    assert fresh[fresh > 0.0].min() >= 2e-3
    passed = np.arange(160) < 75
    assert cut[passed].max() <= 1e-3 + 1e-12
    assert np.array_equal(cut[~passed][20:], fresh[~passed][20:])


def test_an_edge_without_a_burr_is_drawn_without_one() -> None:
    robot: Any = plants.load("cylindrical_robot")
    plain = robot(robot.Parameters(burr_begin=10.0))
    truths = shown(plain)
    plant = plain.drawn(truths)
    plant.reset(1, 1.0)
    model = posed(plant, truths, 0)
    names = [model.geom(i).name for i in range(model.ngeom)]
    assert "casting" in names
    assert not any(name.startswith("burr") for name in names)


@pytest.mark.parametrize("corner", [-0.2, -0.16])
def test_the_casting_rises_and_falls_with_its_edge(corner: float) -> None:
    robot: Any = plants.load("cylindrical_robot")
    plain = robot(robot.Parameters(edge_corner_z=corner))
    plant = plain.drawn(shown(plain))
    model, data = plant.model, plant.data
    mujoco.mj_kinematics(model, data)
    casting, burr = model.geom("casting").id, [model.geom(f"burr{i}").id for i in range(160)]
    mesh = model.mesh("casting")
    vertices = model.mesh_vert[mesh.vertadr[0] : mesh.vertadr[0] + mesh.vertnum[0]]
    heights = data.geom_xpos[casting, 2] + vertices @ data.geom_xmat[casting].reshape(3, 3)[2]
    edge = data.geom_xpos[burr, 2]
    assert heights.max() == pytest.approx(edge.max() + cylindrical_robot.THICK, abs=1e-3)


class Counted(slide.Slide):
    """Slide that is built in an own way, and looks at its model there."""

    def __init__(self, parameters: SlideParameters) -> None:
        super().__init__(parameters)
        self.geoms = self.model.ngeom

    @classmethod
    def _mjcf(cls) -> Path:
        return Path(slide.__file__).with_suffix(".xml")


def test_a_plant_with_an_own_way_to_be_built_is_drawn() -> None:
    plain = Counted(SlideParameters())
    plant: Any = plain.drawn(shown(plain))
    assert plant.geoms == plant.model.ngeom > plain.geoms


def test_the_workpiece_lies_where_the_drawn_tool_meets_it() -> None:
    truths = {"surface": np.full(3, 2e-4)}
    plant = plants.load("slide")().drawn(truths)
    plant.reset(1, 1.0)
    plant.draw(truths, 0, lambda name, value: 100.0 * value if name == "z" else np.nan)
    geom = plant.model.geom("workpiece")
    assert geom.pos[2] + geom.size[2] == pytest.approx(-0.02, abs=1e-12)


def test_the_probe_ends_on_the_ring_that_is_drawn_and_the_pusher_keeps_its_gap() -> None:
    truths = {"pusher_gap": np.array([0.0, 0.05]), "surface": np.array([0.05, 0.05])}
    plant: Any = plants.load("spindle_ring")().drawn(truths)
    plant.reset(1, 1.0)
    for row, follows in ((0, True), (1, False)):
        data = plant.data
        data.joint("spindle").qpos[0] = 0.3
        data.joint("ring_x").qpos[0], data.joint("ring_y").qpos[0] = 0.004, 0.003
        begin = data.joint("slide").qpos[0] = plant.pusher_start - 0.05 - float(truths["pusher_gap"][row])
        model = posed(plant, truths, row)
        moved = float(data.joint("slide").qpos[0] - begin)
        angle = 0.3 + np.arctan2(0.003, 0.004)
        surface = 0.005 * np.cos(angle) + np.sqrt(0.05**2 - (0.005 * np.sin(angle)) ** 2)
        assert moved == pytest.approx(0.05 - surface if follows else 0.0, abs=1e-12)
        ball = data.geom_xpos[model.geom("probe_ball").id]
        free = plant.pusher_start - float(data.joint("slide").qpos[0]) - 0.02
        assert ball[0] - 0.0022 == pytest.approx(max(surface, free), abs=1e-12)


def test_the_lens_is_the_surface_that_the_tool_left() -> None:
    angle = np.linspace(0.0, 40.0, 2001)
    depth = 3e-3 + 1e-3 * np.cos(2.0 * angle)
    truths = {
        "cutting_force": np.ones(2001),
        "spindle_angle": -angle,
        "tip_lateral": np.full(2001, 0.03),
        "tip_depth": depth,
    }
    height = rotary_arm.surface(*rotary_arm.tool_path(truths))
    at = angle[-100:]
    found = height(0.03 * np.cos(at), 0.03 * np.sin(at))
    assert found == pytest.approx(depth[-100:], abs=5e-5)
    assert height(np.zeros(1), np.zeros(1)) == pytest.approx(4e-3, abs=5e-5)


def test_dots_mark_the_path_that_was_rubbed() -> None:
    rows = 50
    truths = {
        "contact_force": np.where(np.arange(rows) < 10, 0.0, 5.0),
        **{f"contact_{axis}": np.linspace(0.0, 1e-3, rows) for axis in "xyz"},
    }
    plant = plants.load("orthogonal_robot")().drawn(truths)
    plant.reset(1, 1.0)
    for row, seen in ((5, 0), (10, 1), (29, 20), (49, 40)):
        model = posed(plant, truths, row)
        dots = [i for i in range(model.ngeom) if model.geom(i).name.startswith("rubbed")]
        assert len(dots) == 40
        assert sum(model.geom_rgba[dots, 3] > 0.0) == seen


@pytest.mark.parametrize(
    ("solid", "volume"),
    [
        (solids.lathe(np.array([(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)])), 3.0 * np.pi),
        (solids.disc(lambda x, y: 1.0 + 0.0 * x, 2.0, 0.0), 4.0 * np.pi),
        (solids.prism(np.array([(0, 0, 1), (2, 0, 0), (2, 1, 0), (0, 1, 1)], dtype=float), 1.0, 4.0), 6.0),
    ],
)
def test_a_solid_is_closed_and_its_faces_look_outward(solid: tuple[Array, Any], volume: float) -> None:
    vertices, faces = solid
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    # the divergence of the position over the volume
    assert float(np.sum(a * np.cross(b, c))) / 6.0 == pytest.approx(volume, rel=2e-3)
