"""Bad robot files and URDFs: exit code 2, and an error that names the file and the line."""

from pathlib import Path

import pytest

import base_scene
from bad_input import SECONDS, refused
from base_scene import line_of, yaml_text


@pytest.fixture
def scene() -> dict:
    return base_scene.scene()


ROBOT = """\
format: clearway-robot/1
urdf: robot.urdf
arm: {base: base, tip: tip}
home: {turn: 0.0, slide: 0.1}
hand:
  kind: parallel
  frame: grasp_center
  joint: finger_joint
  opening: {"0.0": 0.1, "0.05": 0.0}
  links: [finger]
  base_radius: 0.06
  finger_thickness: 0.012
grasps: {kind: side}
"""

URDF = """\
<robot name="small">
  <link name="base"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="arm"/>
  <link name="tip"/>
  <link name="finger"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <link name="grasp_center"/>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="arm"/><child link="tip"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="1" velocity="1" effort="1"/>
  </joint>
  <joint name="finger_joint" type="prismatic">
    <parent link="tip"/><child link="finger"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.05" velocity="1" effort="1"/>
  </joint>
  <joint name="center" type="fixed"><parent link="tip"/><child link="grasp_center"/></joint>
</robot>
"""


def with_robot(
    folder: Path, scene: dict, urdf: str | bytes | None = URDF, robot: str = ROBOT
) -> str:
    """Writes a robot file and its URDF under `robot/`; returns the text of a scene with it."""
    (folder / "robot").mkdir()
    (folder / "robot" / "robot.yaml").write_text(robot)
    if urdf is not None:
        data = urdf if isinstance(urdf, bytes) else urdf.encode()
        (folder / "robot" / "robot.urdf").write_bytes(data)
    scene["robot"]["model"] = "robot/robot.yaml"
    return yaml_text(scene)


def test_the_small_robot_is_sound(clearway, tmp_path, scene):
    """What the tests below spoil is not refused by itself."""
    with_robot(tmp_path, scene)
    done = clearway.run("robot", tmp_path / "robot" / "robot.yaml", seconds=SECONDS)
    assert done.code == 0, done.err


@pytest.mark.parametrize("model", ["ur99", "robots/none.yaml", "/nowhere/robot.yaml"])
def test_no_such_robot(clearway, tmp_path, scene, model):
    scene["robot"]["model"] = model
    refused(clearway, tmp_path, yaml_text(scene), model)


def test_no_such_urdf(clearway, tmp_path, scene):
    text = with_robot(tmp_path, scene, urdf=None)
    refused(clearway, tmp_path, text, "robot.urdf", file="robot.yaml")


def test_an_unknown_key_in_a_robot_file(clearway, tmp_path, scene):
    text = with_robot(tmp_path, scene, robot=ROBOT + "colour: red\n")
    line = line_of(ROBOT + "colour: red\n", "colour")
    refused(clearway, tmp_path, text, "colour", file="robot.yaml", line=line)


@pytest.mark.parametrize("name", ["tip", "grasp_center", "finger_joint"])
def test_a_robot_file_that_names_what_the_urdf_lacks(clearway, tmp_path, scene, name):
    robot = ROBOT.replace(f": {name}", ": ghost")
    text = with_robot(tmp_path, scene, robot=robot)
    refused(clearway, tmp_path, text, "ghost", file="robot.yaml")


@pytest.mark.parametrize("mesh", ["missing.stl", "package://nobody/missing.stl"])
def test_no_such_mesh(clearway, tmp_path, scene, mesh):
    urdf = URDF.replace('<sphere radius="0.01"/>', f'<mesh filename="{mesh}"/>')
    text = with_robot(tmp_path, scene, urdf)
    refused(clearway, tmp_path, text, "missing.stl", file="robot.urdf")


@pytest.mark.parametrize("path", ["../../secret.stl", "package://own/../../secret.stl", "ABSOLUTE"])
def test_a_mesh_that_leaves_its_root(clearway, tmp_path, scene, path):
    """The file is there, two folders up; the robot may not read it."""
    deep = tmp_path / "a" / "b"
    deep.mkdir(parents=True)
    (tmp_path / "a" / "secret.stl").write_text("solid s\nendsolid s\n")
    path = path.replace("ABSOLUTE", str(tmp_path / "a" / "secret.stl"))
    urdf = URDF.replace('<sphere radius="0.01"/>', f'<mesh filename="{path}"/>')
    text = with_robot(deep, scene, urdf, ROBOT + "packages: {own: .}\n")
    refused(clearway, deep, text, "secret.stl", file="robot.urdf")


SPOILT_URDFS = {
    "cycle": URDF.replace(
        "</robot>",
        '  <joint name="back" type="fixed">'
        '<parent link="grasp_center"/><child link="base"/></joint>\n'
        "</robot>",
    ),
    "two-roots": URDF.replace("</robot>", '  <link name="loose"/>\n</robot>'),
    "two-parents": URDF.replace(
        "</robot>",
        '  <joint name="again" type="fixed">'
        '<parent link="base"/><child link="tip"/></joint>\n</robot>',
    ),
    "swapped-limits": URDF.replace('lower="-1" upper="1"', 'lower="1" upper="-1"'),
    "nan-limit": URDF.replace('lower="-1" upper="1"', 'lower="nan" upper="1"'),
    "nan-origin": URDF.replace('type="fixed">', 'type="fixed"><origin xyz="nan 0 0"/>'),
    "zero-axis": URDF.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>'),
    "negative-size": URDF.replace('size="0.1 0.1 0.1"', 'size="0.1 -0.1 0.1"'),
    "two-links-of-one-name": URDF.replace('<link name="arm"/>', '<link name="arm"/>\n' * 2),
    "two-joints-of-one-name": URDF.replace('name="slide"', 'name="turn"'),
    "no-such-link": URDF.replace('<child link="arm"/>', '<child link="leg"/>'),
    "mimic-of-nobody": URDF.replace(
        '<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><mimic joint="ghost"/>'
    ),
    "not-xml": URDF.replace("</robot>", "<link"),
    "wrong-tag": URDF.replace('<link name="tip"/>', '<link name="tip">'),
}  # fmt: skip


@pytest.mark.parametrize("name", SPOILT_URDFS)
def test_spoilt_urdfs(clearway, tmp_path, scene, name):
    text = with_robot(tmp_path, scene, SPOILT_URDFS[name])
    refused(clearway, tmp_path, text, file="robot.urdf", line=True)


def test_the_line_of_swapped_limits(clearway, tmp_path, scene):
    urdf = SPOILT_URDFS["swapped-limits"]
    text = with_robot(tmp_path, scene, urdf)
    done = refused(clearway, tmp_path, text, "turn", file="robot.urdf", line=True)
    first = line_of(urdf, 'name="turn"')
    assert done.lines_named("robot.urdf") & set(range(first, first + 4)), done.err


def test_200_000_nested_tags(clearway, tmp_path, scene):
    text = with_robot(tmp_path, scene, "<robot>" + "<link>" * 200_000 + "</link>" * 200_000)
    refused(clearway, tmp_path, text, file="robot.urdf")


def test_an_entity_bomb(clearway, tmp_path, scene):
    entities = '<!ENTITY a0 "ha">' + "".join(
        f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 30)
    )
    urdf = f"<!DOCTYPE robot [{entities}]>\n" + URDF.replace('name="small"', 'name="&a29;"')
    refused(clearway, tmp_path, with_robot(tmp_path, scene, urdf), file="robot.urdf")


def test_a_50_mb_urdf(clearway, tmp_path, scene):
    urdf = URDF.replace("</robot>", "<!-- filler -->\n" * 3_200_000 + "</robot>")
    refused(clearway, tmp_path, with_robot(tmp_path, scene, urdf), file="robot.urdf")
