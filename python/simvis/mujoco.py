"""Links where another program has them: the bodies of a MuJoCo model, or poses of your own.

    model = mujoco.MjModel.from_xml_path("robot.xml")
    data = mujoco.MjData(model)
    sim = simvis.Simulation.from_string('<part name="ROBOT" insert_at="ROOT" file="robot.xml"/> ...')
    robot = simvis.mujoco.follow(sim, model, data)
    while True:
        mujoco.mj_step(model, data)
        mujoco.mj_kinematics(model, data)      # the poses of the state after the step
        robot.update()
        sim.step()

SimVis then only shows and measures. MuJoCo is not imported here: a model and its data are used as they are.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

from ._errors import InputError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from ._simulation import Simulation

    Matrices = npt.NDArray[np.float64]

__all__ = ["Followed", "follow"]

_UNIT = 1e-6  # by which the length of a quaternion, and of an axis of a matrix, may differ from 1
_MAX_COORDINATE_M = 1e15  # of all scenes


def follow(sim: Simulation, model: Any, data: Any, part: str | None = None) -> Followed:
    """Puts links where `data` has them now, and at each update() of what it returns.

    model  a mujoco.MjModel, or the names of links and parts
    data   its mujoco.MjData, or poses that the caller overwrites, in an array, a list or a tensor of the CPU:
           (n, 7) x y z qw qx qy qz, or (n, 4, 4)
    part   the part in whose frame the poses are: of a model by default the one that has its bodies, of an array the world

    Of a model these are xpos and xquat, which mj_kinematics() and mj_forward() compute; mj_step() leaves them one step
    behind qpos. The model is the file of the part. Its free, jointed, fixed and mocap bodies follow, and what stands in
    the world stays. Each link gets an element NAME_FOLLOWED of the type pose, so that recordings have its motion. The
    joints of the part stay as they are now: one that changes later moves the links behind it away from their poses.
    Raises InputError for another model, a name that is not there, a part that is one of the names, a link that is
    followed already, and what update() raises.
    """
    if hasattr(model, "body_parentid"):
        part, names = _bodies(sim, model, part)
        return Followed(sim, names, _BodyPoses(data, len(names)), part)
    names = list(model)
    if part in names:
        raise InputError(f'the part "{part}" is one of the names, expected a part that stays')
    if len(set(names)) < len(names):
        raise InputError(f"a link is named twice: {', '.join(names)}")
    return Followed(sim, names, _ArrayPoses(data), part)


class Followed:
    """Links that follow poses. `names` are their names, in the order of the poses."""

    def __init__(self, sim: Simulation, names: list[str], poses: _BodyPoses | _ArrayPoses, part: str | None) -> None:
        import numpy as np

        self.names = names
        self._sim, self._poses = sim, poses
        points = sim._nested_points([*names, *([part] if part else [])])
        for name, (pose, _, _) in zip([*names, part], points, strict=False):
            if pose is None:
                raise InputError(f'"{name}" stands in a part that is switched off, expected it on')
        rest: Matrices = np.array([pose for pose, _, _ in points]).reshape(-1, 4, 4)
        groups = np.array([group for _, group, _ in points[:len(names)]]).reshape(-1, 4, 4)
        base = _inverse(rest[len(names):])[0] if part else np.eye(4)
        rest = rest[:len(names)]
        # A link moves those behind it, so that each stands in a group whose place counts from the link in front of it.
        self._front = np.array([-1 if front is None or front >= len(names) else front
                                for _, _, front in points[:len(names)]], int)
        self._group_from_front = _inverse(_inverse(self._fronts(base @ rest)) @ base @ groups)
        self._link_from_group = _inverse(_inverse(groups) @ rest)
        self._elements = [f"{name}_FOLLOWED" for name in names]
        taken = set(sim._element_names())
        for name, element in zip(names, self._elements, strict=True):
            if element in taken:
                raise InputError(f'"{name}" is followed already, or has another element "{element}"')
        placed = self._placed(poses.matrices(names))
        sim.execute("".join(f"<element type=\"pose\" moves=\"all\" name={quoteattr(element)} insert_at={quoteattr(name)}/>"
                            for name, element in zip(names, self._elements, strict=True)), name="simvis.mujoco.follow")
        self._set(placed)

    def update(self) -> None:
        """Puts the links where the poses are now; the next step() shows them.

        Raises InputError, and moves nothing, if the poses have another shape, or if one is not finite, no rotation and
        translation, or more than 1e15 m away.
        """
        self._set(self._placed(self._poses.matrices(self.names)))

    def _placed(self, wanted: Matrices) -> Matrices:
        """The poses of the elements, which all can be set."""
        poses: Matrices = self._group_from_front @ _inverse(self._fronts(wanted)) @ wanted @ self._link_from_group
        _require(self.names, wanted, _are_rigid(poses), "that no element scales the part")
        _require(self.names, wanted, _are_near(poses[:, :3, 3]), _NEAR)
        return poses

    def _set(self, poses: Matrices) -> None:
        for element, pose in zip(self._elements, poses, strict=True):
            self._sim._set_pose(element, pose)

    def _fronts(self, poses: Matrices) -> Matrices:
        """Of each link the pose of the one in front of it; without one the frame of all poses."""
        import numpy as np

        fronts: Matrices = np.concatenate([poses, np.eye(4)[None]])[self._front]
        return fronts


class _BodyPoses:
    """Of the bodies of MuJoCo, the world left out."""

    def __init__(self, data: Any, count: int) -> None:
        if not hasattr(data, "xpos") or len(data.xpos) != count + 1:
            raise InputError(f"data is {type(data).__name__} of another model, expected the MjData of this one")
        self._data = data

    def matrices(self, names: list[str]) -> Matrices:
        return _matrices(names, self._data.xpos[1:], self._data.xquat[1:])


class _ArrayPoses:
    """Of the caller's object, which is read anew each time."""

    def __init__(self, array: Any) -> None:
        self._array = array

    def matrices(self, names: list[str]) -> Matrices:
        import numpy as np

        count = len(names)
        try:
            poses = np.array(self._array, np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"the poses are no array of numbers: {error}") from None
        if poses.shape not in ((count, 7), (count, 4, 4)):
            raise InputError(f"the poses have shape {poses.shape}, expected ({count}, 7) or ({count}, 4, 4) for {count} "
                             "names")
        if poses.ndim == 2:
            return _matrices(names, poses[:, :3], poses[:, 3:])
        _require(names, poses, np.isfinite(poses).all(axis=(1, 2)), "finite numbers")
        rigid = _are_rigid(poses) & (poses[:, 3] == [0, 0, 0, 1]).all(axis=1)
        _require(names, poses, rigid, "a rotation and a translation")
        _require(names, poses, _are_near(poses[:, :3, 3]), _NEAR)
        left, _, right = np.linalg.svd(poses[:, :3, :3])
        poses[:, :3, :3] = left @ right  # the nearest rotation
        return poses


def _matrices(names: list[str], places: Any, quaternions: Any) -> Matrices:
    import numpy as np

    numbers = np.concatenate([places, quaternions], axis=1)
    _require(names, numbers, np.isfinite(numbers).all(axis=1), "finite numbers")
    lengths = np.linalg.norm(quaternions, axis=1)
    _require(names, numbers, np.abs(lengths - 1) <= _UNIT, "a quaternion of length 1")
    _require(names, numbers, _are_near(numbers[:, :3]), _NEAR)
    w, x, y, z = (quaternions / lengths[:, None]).T
    poses = np.zeros((len(names), 4, 4))
    poses[:, :3, 0] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=1)
    poses[:, :3, 1] = np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)], axis=1)
    poses[:, :3, 2] = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)
    poses[:, :3, 3] = places
    poses[:, 3, 3] = 1
    return poses


_NEAR = "coordinates of at most 1e15 m"


def _are_near(places: Any) -> Any:
    return (abs(places) <= _MAX_COORDINATE_M).all(axis=1)


def _are_rigid(poses: Any) -> Any:
    import numpy as np

    turns = poses[:, :3, :3]
    return (np.abs(turns @ turns.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2)) <= _UNIT) & (np.linalg.det(turns) > 0)


def _require(names: list[str], poses: Any, good: Any, expected: str) -> None:
    if not good.all():
        i = int(good.argmin())
        raise InputError(f'the pose of "{names[i]}" is {poses[i].tolist()}, expected {expected}')


def _inverse(rigid: Matrices) -> Matrices:
    import numpy as np

    turned = rigid[:, :3, :3].transpose(0, 2, 1)
    inverse = np.zeros_like(rigid)
    inverse[:, :3, :3] = turned
    inverse[:, :3, 3] = -(turned @ rigid[:, :3, 3:])[:, :, 0]
    inverse[:, 3, 3] = 1
    return inverse


def _bodies(sim: Simulation, model: Any, part: str | None) -> tuple[str, list[str]]:
    """The part whose links are the bodies of the model, and their names, in MuJoCo's order."""
    bodies = [model.body(i).name for i in range(1, model.nbody)]
    parts = {row["instance"]: row["name"] for row in sim.objects if row["kind"] == "part"}
    links: dict[str, list[str]] = {name: [] for name in parts.values()}
    for row in sim.objects:
        if row["kind"] == "link" and row["parent"] in parts:
            links[parts[row["parent"]]].append(row["name"])
    if part is not None:
        if part not in links:
            raise InputError(f'there is no part "{part}", expected one of {", ".join(links)}')
        links = {part: links[part]}
    wrong = {name: _difference(bodies, links[name]) for name in links}
    found = [name for name, difference in wrong.items() if not difference]
    if len(found) > 1:
        raise InputError(f"the parts {', '.join(found)} have these bodies, expected part= with one of them")
    if not found:
        nearest = max(links, key=lambda name: len(set(links[name]) & set(bodies)), default=None)
        reason = f', in "{nearest}" {wrong[nearest]}' if nearest else ""
        raise InputError(f"no part has the bodies of this model{reason}; expected a part from the model's file")
    return found[0], links[found[0]]


def _difference(bodies: Sequence[str], links: Sequence[str]) -> str:
    if len(bodies) != len(links):
        return f"are {len(links)} links for {len(bodies)} bodies"
    for body, link in zip(bodies, links, strict=True):
        # Links have a prefix where the file is inserted several times, and a number where a name was taken.
        if body and not re.fullmatch(rf"(.*/)?{re.escape(body)}(_\d+)?", link):
            return f'the link "{link}" stands in place of the body "{body}"'
    return ""
