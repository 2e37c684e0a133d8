"""`clearway export --to mcap`: what other people's readers (PyPI `mcap`, `mcap-ros2-support`,
`rosbags`) find in the file, held against the plan."""

import collections
import json
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

import base_scene
from box_stl import write_box_stl
from clearway_cli import BAD_INPUT, SOLVED
from test_user_robot import panda_scene

START = 1_000_000_000
"""Bags begin at one second."""
CUBE, SPHERE, CYLINDER, SPHERES, TRIANGLES = 1, 2, 3, 7, 11
ROOT = Path(__file__).parents[2]
LATCHED = {"/robot_description", "/tf_static", "/scene/fixtures", "/scene/objects"}
# Numbers read from the plan may differ in their last digit.
NEAR = dict(rtol=0, atol=1e-12)


class Bag:
    """A bag's messages by topic, as pairs of log time (ns) and message."""

    def __init__(self, path: Path) -> None:
        self.path = path
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
            self.header, self.summary = reader.get_header(), reader.get_summary()
            self.metadata = {m.name: m.metadata for m in reader.iter_metadata()}
            self.attachments = {a.name: a for a in reader.iter_attachments()}
            self.topics = collections.defaultdict(list)
            for _, channel, message, decoded in reader.iter_decoded_messages():
                self.topics[channel.topic].append((message.log_time, decoded))

    def at(self, topic: str, time: int):
        """The last message that a viewer at `time` knows."""
        return [message for when, message in self.topics[topic] if when <= time][-1]


def exported(clearway, plan: Path) -> Bag:
    path = plan.with_suffix(".mcap")
    done = clearway.run("export", plan, "--to", "mcap", "-o", path)
    assert done.code == SOLVED and not done.err and not done.out, done.err
    return Bag(path)


def segments(plan: dict):
    """(step, segment, ns at its first row), in order."""
    clock = START
    for step in plan["steps"]:
        for segment in step["segments"]:
            yield step, segment, clock
            clock += round(segment["times"][-1] * 1e9)


def rows(plan: dict) -> tuple[list[int], np.ndarray]:
    """Every row once: ns, positions."""
    times, positions = [], []
    for _, segment, start in segments(plan):
        skip = 1 if times else 0
        times += [start + round(t * 1e9) for t in segment["times"][skip:]]
        positions += segment["positions"][skip:]
    return times, np.array(positions)


def placed(marker) -> np.ndarray:
    return np.array([getattr(marker.pose.position, k) for k in "xyz"])


def stamp(time) -> int:
    return time.sec * 10**9 + time.nanosec


@pytest.fixture(scope="module")
def plans(clearway, tmp_path_factory) -> dict[str, tuple[dict, Bag]]:
    """A plan and its bag for each robot that tests look at."""
    directory, made = tmp_path_factory.mktemp("mcap"), {}
    scene = directory / "ur10.yaml"
    done = clearway.run("generate", "shelf", "--objects", 8, "--seed", 3, "-o", scene)
    assert done.code == SOLVED, done.err
    cabinet = panda_scene()
    cabinet["robot"]["model"] = "panda"
    panda = base_scene.write(directory, cabinet)
    scenes = {"ur10": scene, "panda": panda, "pr2": ROOT / "examples/pr2_table.yaml"}
    for name, scene in scenes.items():
        plan = directory / f"{name}.json"
        clearway.solve(scene, plan, "--seed", 1)
        made[name] = json.loads(plan.read_text()), exported(clearway, plan)
    return made


@pytest.fixture(params=["ur10", "panda", "pr2"])
def both(request, plans) -> tuple[dict, Bag]:
    return plans[request.param]


def test_the_file_is_a_ros_2_bag(both):
    plan, bag = both
    assert bag.header.profile == "ros2" and bag.header.library.startswith("clearway ")
    assert bag.summary.statistics.message_start_time == START
    end = START + round(sum(s["times"][-1] for _, s, _ in segments(plan)) * 1e9)
    assert abs(bag.summary.statistics.message_end_time - end) < 1000
    for channel in bag.summary.channels.values():
        assert channel.message_encoding == "cdr"
        durability = 1 if channel.topic in LATCHED else 2
        assert f"\n  durability: {durability}\n" in channel.metadata["offered_qos_profiles"]
    assert {s.encoding for s in bag.summary.schemas.values()} == {"ros2msg"}
    # rosbag2 takes the numbers above as such because of this record.
    assert bag.metadata["rosbag2"]["serialized_metadata"] == ""
    assert bag.topics["/robot_description"][0][1].data == plan["robot"]["urdf"]


def test_rosbags_reads_it_and_would_write_the_same(both):
    _, bag = both
    stores = [get_typestore(s) for s in (Stores.ROS2_HUMBLE, Stores.ROS2_JAZZY, Stores.LATEST)]
    schemas = {s.name: s.data.decode() for s in bag.summary.schemas.values()}
    for name, text in schemas.items():
        for kind, (_, fields) in get_types_from_msg(text, name).items():
            for store in stores:
                assert fields == store.fielddefs[kind][1], kind
    with Reader(bag.path) as reader:
        assert reader.message_count == sum(map(len, bag.topics.values()))
        for connection, _, raw in reader.messages():
            for store in stores:
                message = store.deserialize_cdr(raw, connection.msgtype)
                assert bytes(store.serialize_cdr(message, connection.msgtype)) == bytes(raw)


def test_joint_states_are_the_plans_rows(both):
    plan, bag = both
    times, positions = rows(plan)
    states = bag.topics["/joint_states"]
    assert [time for time, _ in states] == pytest.approx(times, abs=100, rel=0)
    assert all(stamp(s.header.stamp) == time for time, s in states)
    names = states[0][1].name
    assert names[: len(plan["robot"]["joints"])] == plan["robot"]["joints"]
    assert all(s.name == names and len(s.velocity) == len(names) for _, s in states)
    got = np.array([s.position for _, s in states])
    np.testing.assert_allclose(got[:, : positions.shape[1]], positions, **NEAR)
    for joint, value in plan["robot"]["fixed"].items():
        assert np.all(got[:, names.index(joint)] == value)
    speeds = np.array([s.velocity for _, s in states])
    assert np.all(speeds[0] == 0) and np.all(speeds[-1] == 0)
    limits = np.array([plan["robot"]["limits"]["velocity"][n] for n in plan["robot"]["joints"]])
    assert np.all(np.abs(speeds[:, : len(limits)]) <= limits * (1 + 1e-6))
    # Half way on, the trapezoid rule leads from row to row.
    seconds = np.diff([t for t, _ in states])[:, None] / 1e9
    moved = 0.5 * (speeds[1:] + speeds[:-1]) * seconds
    assert np.abs(got[1:] - got[:-1] - moved).max() < 0.01


def test_the_gripper_and_what_mimics_it(plans):
    plan, bag = plans["panda"]
    names = bag.topics["/joint_states"][0][1].name
    one, two = (names.index(f"panda_finger_joint{i}") for i in (1, 2))
    for _, segment, start in segments(plan):
        value = segment["gripper"]["panda_finger_joint1"]
        value = value[-1] if isinstance(value, list) else value
        end = start + round(segment["times"][-1] * 1e9) + 100
        position = bag.at("/joint_states", end).position
        assert position[one] == position[two] == pytest.approx(value, abs=1e-15)


def frames(bag: Bag, time: int) -> dict[str, tuple[str, np.ndarray]]:
    """By link: what it hangs from, and its pose there."""
    found = {}
    for topic in ("/tf_static", "/tf"):
        for t in bag.at(topic, time).transforms:
            assert t.child_frame_id not in found, "a frame has one parent"
            q, p = t.transform.rotation, t.transform.translation
            rotation = pinocchio.Quaternion(q.w, q.x, q.y, q.z).matrix()
            pose = pinocchio.SE3(rotation, np.array([p.x, p.y, p.z])).homogeneous
            found[t.child_frame_id] = t.header.frame_id, pose
    return found


def seen_from_root(found: dict, link: str, root: str) -> np.ndarray:
    pose = np.eye(4)
    while link != root:
        link, parent_from_link = found[link]
        pose = parent_from_link @ pose
    return pose


def test_frames_are_where_pinocchio_has_the_links(both):
    plan, bag = both
    model = pinocchio.buildModelFromXML(plan["robot"]["urdf"])
    data, world = model.createData(), plan["scene"]["frame"]
    base = plan["scene"]["robot"]["base"]
    rotation = (
        pinocchio.Quaternion(np.array(base["quaternion"])).matrix()
        if base.get("quaternion")
        else pinocchio.rpy.rpyToMatrix(np.array(base.get("rpy") or [0.0] * 3))
    )
    world_from_root = pinocchio.SE3(rotation, np.array(base["position"])).homogeneous
    states = bag.topics["/joint_states"]
    links = [f for f in model.frames if f.type == pinocchio.FrameType.BODY]
    for time, state in states[:: len(states) // 20]:
        q = pinocchio.neutral(model)
        for name, value in zip(state.name, state.position):
            joint = model.joints[model.getJointId(name)]
            if joint.nq == 2:  # turns without end: cosine and sine
                q[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
            else:
                q[joint.idx_q] = value
        pinocchio.framesForwardKinematics(model, data, q)
        found = frames(bag, time)
        for frame in links:
            expected = world_from_root @ data.oMf[model.getFrameId(frame.name)].homogeneous
            got = seen_from_root(found, frame.name, world)
            np.testing.assert_allclose(got, expected, rtol=0, atol=1e-9, err_msg=frame.name)


def test_objects_stand_are_held_and_stand_again(both):
    plan, bag = both
    world = plan["scene"]["frame"]
    first = {m.ns: m for m in bag.at("/scene/objects", START).markers}
    assert set(first) == {o["id"] for o in plan["scene"]["objects"]}
    for keys in plan["scene"]["objects"]:
        np.testing.assert_allclose(placed(first[keys["id"]]), keys["position"], **NEAR)
        if "cylinder" in keys:
            marker, size = first[keys["id"]], keys["cylinder"]
            assert marker.type == CYLINDER and marker.scale.z == size["height"]
            assert marker.scale.x == marker.scale.y == 2 * size["radius"]
    for step, segment, start in segments(plan):
        # A row into the segment; its first row may still be the last segment's.
        markers = bag.at("/scene/objects", start + 1000).markers
        marker = next(m for m in markers if m.ns == step["object"])
        if held := segment["attached"]:
            assert marker.header.frame_id == held["tool"] and marker.frame_locked
            np.testing.assert_allclose(placed(marker), held["pose_in_tool"]["position"], **NEAR)
        else:
            assert marker.header.frame_id == world
    last = {m.ns: m for m in bag.topics["/scene/objects"][-1][1].markers}
    for step in plan["steps"]:
        marker, q = last[step["object"]], last[step["object"]].pose.orientation
        np.testing.assert_allclose(placed(marker), step["placed"]["position"], **NEAR)
        turned = abs(np.dot([q.x, q.y, q.z, q.w], step["placed"]["quaternion"]))
        assert turned == pytest.approx(1, abs=1e-9)
    colours = {ns: (m.color.r, m.color.g, m.color.b) for ns, m in last.items()}
    target = plan["scene"]["target"]
    assert all(colour != colours[target] for ns, colour in colours.items() if ns != target)


def test_what_is_put_down_was_carried_there(plans):
    """By the bag alone: hand and object arrive where the object then stands."""
    plan, bag = plans["ur10"]
    for step, segment, start in segments(plan):
        if segment["kind"] != "transfer":
            continue
        end = start + round(segment["times"][-1] * 1e9)
        markers = bag.at("/scene/objects", start + 1000).markers
        held = next(m for m in markers if m.ns == step["object"])
        tool = seen_from_root(frames(bag, end + 100), held.header.frame_id, plan["scene"]["frame"])
        there = (tool @ np.append(placed(held), 1))[:3]
        assert np.abs(there - step["placed"]["position"]).max() < 0.002


def test_the_log_tells_every_step_and_segment(both):
    plan, bag = both
    expected = []
    for number, step in enumerate(plan["steps"], 1):
        why = [w["reason"] for w in plan["why"]["objects"] if w["object"] == step["object"]]
        verb = {"pick_place": "take", "push": "push"}[step["action"]]
        begins = f"step {number} of {len(plan['steps'])}: {verb} {step['object']}"
        expected.append(begins + (f": {why[0]}" if why and why[0] else ""))
        expected += [f"{step['object']}: {s['kind']}" for s in step["segments"]]
    log = [message for _, message in bag.topics["/events"]]
    assert [m.msg for m in log] == expected
    assert {(m.level, m.name) for m in log} == {(20, "clearway")}
    kinds = [m for m in log if not m.msg.startswith("step ")]
    starts = [start for _, _, start in segments(plan)]
    assert [stamp(m.stamp) for m in kinds] == pytest.approx(starts, abs=100, rel=0)


def test_trajectories_are_those_of_the_other_export(clearway, both):
    _, bag = both
    done = clearway.run("export", bag.path.with_suffix(".json"), "--to", "joint-trajectory")
    items = json.loads(done.out)
    expected = [item["trajectory"] for item in items if "trajectory" in item]
    found = [message for _, message in bag.topics["/trajectory"]]
    assert len(found) == len(expected) > 0
    for message, item in zip(found, expected):
        assert message.joint_names == item["joint_names"]
        assert (message.header.stamp.sec, message.header.stamp.nanosec) == (0, 0)
        assert len(message.points) == len(item["points"])
        for point, want in zip(message.points, item["points"]):
            for list_ in ("positions", "velocities", "accelerations", "effort"):
                assert list(getattr(point, list_)) == want[list_]
            assert stamp(point.time_from_start) == (
                want["time_from_start"]["sec"] * 10**9 + want["time_from_start"]["nanosec"]
            )


def test_the_plan_is_in_the_bag(both):
    plan, bag = both
    attached = json.loads(bag.attachments["plan.json"].data)
    assert set(attached) == set(plan) and attached["removed"] == plan["removed"]
    np.testing.assert_allclose(rows(attached)[1], rows(plan)[1], **NEAR)
    said = bag.metadata["clearway"]
    assert said["removed"] == ", ".join(plan["removed"]) and said["status"] == "solved"
    assert said["target"] == plan["scene"]["target"] and said["seed"] == "1"
    if plan.get("lower_bound"):
        assert said["lower_bound"] == str(plan["lower_bound"]["removed"])


def test_one_plan_gives_the_same_bytes_wherever_they_go(clearway, plans):
    _, bag = plans["ur10"]
    again = bag.path.with_name("again.mcap")
    done = clearway.run("export", bag.path.with_suffix(".json"), "--to", "mcap", "-o", again)
    assert done.code == SOLVED and again.read_bytes() == bag.path.read_bytes()


def test_meshes_and_points_are_drawn_from_their_files(clearway, plans, tmp_path):
    """The plan as it is, with a mesh and a cloud beside it that nothing comes near."""
    plan = json.loads(json.dumps(plans["ur10"][0]))
    write_box_stl(tmp_path / "box.stl", ([0, 0, 0], [0.1, 0.2, 0.3]))
    (tmp_path / "wall.xyz").write_text("0 0 0\n0 0.1 0\n0 0 0.2\n")
    plan["scene"]["fixtures"] += [
        {"id": "crate", "mesh": {"file": "box.stl", "scale": 2}, "position": [5, 0, 0]},
        {"id": "wall", "points": {"file": "wall.xyz", "radius": 0.01}, "position": [6, 0, 0]},
        {"id": "pill", "capsule": {"radius": 0.1, "height": 0.4}, "position": [7, 0, 0]},
    ]
    for name in ("box.stl", "wall.xyz"):
        plan["robot"]["meshes"].append({"uri": name, "file": name, "sha256": ""})
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(plan))
    bag = exported(clearway, path)
    drawn = collections.defaultdict(list)
    for marker in bag.topics["/scene/fixtures"][0][1].markers:
        drawn[marker.ns].append(marker)
    (crate,), (wall,) = drawn["crate"], drawn["wall"]
    assert crate.type == TRIANGLES and len(crate.points) % 3 == 0 and len(crate.points) >= 36
    corners = np.array([[p.x, p.y, p.z] for p in crate.points])
    np.testing.assert_allclose(np.ptp(corners, axis=0), [0.2, 0.4, 0.6], atol=1e-6)
    assert wall.type == SPHERES and len(wall.points) == 3 and wall.scale.x == 0.02
    assert [m.type for m in drawn["pill"]] == [CYLINDER, SPHERE, SPHERE]
    assert [m.type for m in drawn["tray"]] == [CUBE]

    (tmp_path / "box.stl").unlink()
    done = clearway.run("export", path, "--to", "mcap", "-o", tmp_path / "less.mcap")
    assert done.code == SOLVED and "not drawn" in done.err and "box.stl" in done.err
    names = {m.ns for m in Bag(tmp_path / "less.mcap").topics["/scene/fixtures"][0][1].markers}
    assert "wall" in names and "crate" not in names


@pytest.mark.parametrize(
    "broken, said",
    [
        (lambda p: p.update(steps=[]), "no motion"),
        (lambda p: p["robot"].update(urdf="<robot"), "robot.urdf"),
        (lambda p: p["robot"]["joints"].__setitem__(0, "nose"), "robot.joints[0]"),
        (lambda p: p["steps"][0].update(object="nobody"), "`nobody`"),
        (lambda p: p["steps"][0]["segments"][0]["times"].__setitem__(3, -1.0), "times[3]"),
        (lambda p: p["scene"].update(frame="wrist_1_link"), "`frame`"),
    ],
)
def test_bad_plans_leave_nothing_behind(clearway, plans, tmp_path, broken, said):
    plan = json.loads(json.dumps(plans["ur10"][0]))
    broken(plan)
    path, out = tmp_path / "plan.json", tmp_path / "out.mcap"
    path.write_text(json.dumps(plan))
    done = clearway.run("export", path, "--to", "mcap", "-o", out)
    assert done.code == BAD_INPUT and said in done.err and not out.exists()


def test_names_for_other_drivers(clearway, plans):
    """`--rename`, and the gap beside the gripper's joint."""
    plan, bag = plans["panda"]
    path = bag.path.with_suffix(".json")
    items = json.loads(clearway.run("export", path, "--to", "joint-trajectory").out)
    arm = [f"panda_joint{i}" for i in range(1, 8)]
    assert all(i["trajectory"]["joint_names"] == arm for i in items if "trajectory" in i)
    for command in (c for i in items for c in i.get("gripper", [])):
        assert command["joint"] == "panda_finger_joint1"
        assert command["gap"] == pytest.approx(2 * command["command"]["position"], abs=1e-12)
    done = clearway.run("export", path, "--to", "joint-trajectory", "--rename", "panda_=fer_")
    renamed = json.loads(done.out.replace("fer_", "panda_"))
    assert renamed == items and '"fer_joint7"' in done.out and "panda_" not in done.out
    for more, said in [(["--rename", "ur_=x_"], "`ur_`"), (["--rename", "panda_"], "OLD=NEW")]:
        done = clearway.run("export", path, "--to", "csv", *more)
        assert done.code == BAD_INPUT and said in done.err
    renamed = ["--rename", "panda_=fer_", "-o", path.with_name("x.mcap")]
    done = clearway.run("export", path, "--to", "mcap", *renamed)
    assert done.code == BAD_INPUT and "--rename" in done.err

    ur10 = plans["ur10"][1].path.with_suffix(".json")
    items = json.loads(clearway.run("export", ur10, "--to", "joint-trajectory").out)
    order = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
    names = [i["trajectory"]["joint_names"] for i in items if "trajectory" in i]
    assert all(n == [f"{j}_joint" for j in order] for n in names)
