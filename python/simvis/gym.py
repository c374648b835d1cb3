"""Scenes as environments of Gymnasium, which must be installed: pip install gymnasium.

    import gymnasium
    from simvis.gym import CameraObservation, ScanObservation          # registers the ids, too

    env = gymnasium.make("simvis/Drive-v0")                            # a robot with a scanner must not bump
    env = gymnasium.make("simvis/Scene-v0", scene="room.xml", actions={"DRIVE.speed": (0, 1), "DRIVE.turn": (-90, 90)})
    env = CameraObservation(ScanObservation(env, "FRONT", reach_m=10), "CAM")

An observation is a dict: "parameters", and an entry of the sensor's name for each wrapper.

    envs = gymnasium.make_vec("simvis/Drive-v0", num_envs=100)         # stepped together, see VectorSimulation
    envs = gymnasium.make_vec("simvis/Scene-v0", num_envs=100, scene="room.xml", actions=..., outputs=["FRONT.range_m"])
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, cast

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from gymnasium.utils import RecordConstructorArgs

from ._errors import InputError
from ._scenes import scene as scene_of_package
from ._simulation import Simulation
from ._vector import VectorSimulation
from ._vector_env import Observations, SceneVectorEnv

__all__ = ["CameraObservation", "DriveEnv", "DriveVectorEnv", "Observation", "ScanObservation", "SceneEnv", "SceneVectorEnv",
           "register_envs"]

Observation = dict[str, npt.NDArray[Any]]
Action = npt.NDArray[np.float32]


class SceneEnv(gymnasium.Env[Observation, Action]):
    """A scene file: an action sets parameters, and then a frame is made.

    actions        parameters by "ELEMENT.PARAMETER" with the limits of their values, in the units of the element's table
    parameters     parameters whose values are observed; None: those of `actions`
    sensors        the sensors that measure; None: all. Others cost nothing
    reward, ended  functions of the simulation after each frame; None: 0 and False
    reload         reset() loads the scene again, so that an episode depends on its seed alone, also with bodies and noise.
                   False: it only sets all parameters back, which is fast; bodies stay where they are
    render_camera  the sensor whose picture render() returns, with render_mode="rgb_array"
    settings       as of Simulation.load(), without the seed, which each episode draws from that of reset()
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 15}

    def __init__(self, scene: str | os.PathLike[str], actions: Mapping[str, tuple[float, float]], *,
                 parameters: Sequence[str] | None = None, sensors: Sequence[str] | None = None,
                 reward: Callable[[Simulation], float] | None = None, ended: Callable[[Simulation], bool] | None = None,
                 reload: bool = True, render_mode: str | None = None, render_camera: str = "", **settings: Any) -> None:
        if render_mode is not None and (render_mode not in self.metadata["render_modes"] or not render_camera):
            raise InputError(f'render_mode is {render_mode!r}, expected None, or "rgb_array" with render_camera')
        if not actions:
            raise InputError('actions is empty, expected parameters such as {"DRIVE.speed": (0, 1)}')
        self.render_mode: str | None = render_mode
        self._render_camera = render_camera
        self._scene, self._settings, self._sensors = os.path.abspath(scene), settings, sensors
        self._actions, self._parameters = list(actions), list(actions if parameters is None else parameters)
        self._reward, self._ended, self._reload = reward, ended, reload
        low, high = np.array(list(actions.values()), np.float32).T
        self.action_space: spaces.Space[Action] = spaces.Box(low, high)
        self.observation_space: spaces.Space[Any] = spaces.Dict(
            {"parameters": spaces.Box(-np.inf, np.inf, (len(self._parameters),))})
        #: The simulation; with `reload` another one after each reset().
        self.sim: Simulation = self._load(0)
        self._start = dict(self.sim.parameters)
        self._frames = 0  # since reset()

    def _load(self, seed: int) -> Simulation:
        sim = Simulation.load(self._scene, seed=seed, **self._settings)
        if self._sensors is not None:
            sim.only(*self._sensors, *([self._render_camera] if self.render_mode else []))
        sim.step()
        return sim

    def begin(self) -> None:
        """Called by reset() before the first frame of an episode, to draw a start by self.np_random. Does nothing."""

    def apply(self, action: Action) -> None:
        """Sets the parameters of an action."""
        for name, value in zip(self._actions, action):
            self.sim.parameters[name] = float(value)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        """Begins an episode. The same seed gives the same episodes."""
        super().reset(seed=seed)
        if self._reload:
            self.sim.close()
            self.sim = self._load(int(self.np_random.integers(1 << 32)))
        else:
            self.sim.parameters.update(self._start)
        self.begin()
        self.sim.step()
        self._frames = 0
        return self._observation(), {"frames": 0}

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Sets the parameters, makes a frame and returns what was measured."""
        self.apply(action)
        self.sim.step()
        self._frames += 1
        reward = 0.0 if self._reward is None else float(self._reward(self.sim))
        ended = False if self._ended is None else bool(self._ended(self.sim))
        return self._observation(), reward, ended, False, {"frames": self._frames}

    def _observation(self) -> Observation:
        return {"parameters": np.array([self.sim.parameters[name] for name in self._parameters], np.float32)}

    def render(self) -> Any:
        """The picture of `render_camera`, (h, w, 3) uint8; None without a render_mode."""
        return self.sim.sensors[self._render_camera].rgb if self.render_mode else None

    def close(self) -> None:
        """Ends the simulation."""
        self.sim.close()


_DRIVE: dict[str, Any] = {"actions": {"speed": (0, 1), "turn": (-90, 90)}, "parameters": ["R_POSE.x", "R_POSE.y", "R_POSE.yaw"],
                          "render_camera": "ROOM_CAM"}
_BUMP = -10.0


def _driven(x: Any, y: Any, yaw_deg: Any, speed: Any, turn_deg: Any) -> tuple[Any, Any, Any]:
    """The pose after a frame, of one robot or of many: by the same functions, so that all digits are the same."""
    yaw = np.radians(yaw_deg + turn_deg)
    return x + speed * np.cos(yaw), y + speed * np.sin(yaw), np.degrees(yaw)


class DriveEnv(SceneEnv):
    """The robot of the scene marvin drives through the laboratory, and must not come nearer than 0.4 m to anything.

    Action: speed in m/s and turn in degrees per second. Reward: the way in metres; a bump costs 10 and ends the episode.
    """

    def __init__(self, *, radius_m: float = 0.4, cameras: Sequence[str] = (), reload: bool = True,
                 render_mode: str | None = None, **settings: Any) -> None:
        self._radius_m, self._way_m = radius_m, 0.0
        super().__init__(scene_of_package("marvin"), sensors=["FRONT_SCANNER", *cameras], reward=self._earned,
                         ended=self._bumped, reload=reload, render_mode=render_mode, **{**_DRIVE, "rate_hz": 10, **settings})
        self._frame_s = 1 / float(settings.get("rate_hz", 10))

    def begin(self) -> None:
        """Turns the robot to any side."""
        self.sim["R_POSE"].yaw = float(self.np_random.uniform(-180, 180))

    def apply(self, action: Action) -> None:
        """Moves the robot by speed and turn."""
        robot, (speed, turn) = self.sim.elements["R_POSE"], (float(each) * self._frame_s for each in action)
        robot.x, robot.y, robot.yaw = _driven(robot.x, robot.y, robot.yaw, speed, turn)
        self._way_m = speed

    def _bumped(self, sim: Simulation) -> bool:
        return bool(sim.sensors["FRONT_SCANNER"].range_m.min() < self._radius_m)

    def _earned(self, sim: Simulation) -> float:
        return _BUMP if self._bumped(sim) else self._way_m


class DriveVectorEnv(SceneVectorEnv):
    """Many DriveEnv with a ScanObservation, or with a CameraObservation of each of `cameras`."""

    def __init__(self, num_envs: int, *, radius_m: float = 0.4, cameras: Sequence[str] = (), reach_m: float = 10.0,
                 reload: bool = True, max_episode_steps: int | None = None, render_mode: str | None = None,
                 **settings: Any) -> None:
        self._radius_m, self._reach_m, self._cameras = radius_m, np.float32(reach_m), tuple(cameras)
        self._way_m = np.zeros(num_envs)
        super().__init__(num_envs, scene_of_package("marvin"), sensors=["FRONT_SCANNER", *cameras], reward=self._earned,
                         ended=self._bumped, reload=reload, max_episode_steps=max_episode_steps, render_mode=render_mode,
                         **{**_DRIVE, "rate_hz": 10, **settings})
        self._frame_s = 1 / float(settings.get("rate_hz", 10))

    def begin(self, environments: Sequence[int]) -> None:
        """Turns the robots to any side."""
        yaw = self.sims.parameters["R_POSE.yaw"]
        for i in environments:
            yaw[i] = self.randoms[i].uniform(-180, 180)
        self.sims.parameters["R_POSE.yaw"] = yaw

    def apply(self, actions: npt.NDArray[Any], acting: npt.NDArray[np.bool_]) -> None:
        """Moves the robots by speed and turn."""
        speed, turn = actions.T.astype(np.float64) * self._frame_s
        x, y, yaw = (self.sims.parameters[f"R_POSE.{name}"] for name in ("x", "y", "yaw"))
        for name, old, new in zip(("x", "y", "yaw"), (x, y, yaw), _driven(x, y, yaw, speed, turn)):
            self.sims.parameters[f"R_POSE.{name}"] = np.where(acting, new, old)
        self._way_m = speed

    def _bumped(self, sims: VectorSimulation) -> npt.NDArray[np.bool_]:
        bumped: npt.NDArray[np.bool_] = sims.outputs["FRONT_SCANNER.range_m"].min(axis=(1, 2)) < self._radius_m
        return bumped

    def _earned(self, sims: VectorSimulation) -> npt.NDArray[np.float64]:
        return np.where(self._bumped(sims), _BUMP, self._way_m)

    def _observations(self) -> Observations:
        seen = {name: np.array(self.sims.outputs[f"{name}.rgb"]) for name in self._cameras}
        if not seen:
            seen["FRONT_SCANNER"] = np.minimum(self.sims.outputs["FRONT_SCANNER.range_m"], self._reach_m)
        return {**super()._observations(), **seen}

    def _spaces(self) -> dict[str, spaces.Space[Any]]:
        own = super()._spaces()
        if not self._cameras:
            own["FRONT_SCANNER"] = spaces.Box(0, float(self._reach_m), own["FRONT_SCANNER"].shape, np.float32)
        return own


class _SensorObservation(gymnasium.ObservationWrapper[Observation, Action, Observation], RecordConstructorArgs):
    """Adds what a sensor measured to the observation, under the sensor's name."""

    def __init__(self, env: gymnasium.Env[Observation, Action], sensor: str, **settings: Any) -> None:
        RecordConstructorArgs.__init__(self, sensor=sensor, **settings)
        gymnasium.ObservationWrapper.__init__(self, env)
        self._sensor = sensor
        if not isinstance(env.observation_space, spaces.Dict):
            raise InputError(f"the environment observes {env.observation_space}, expected a dict as of SceneEnv")
        space = spaces.Dict({**env.observation_space.spaces, sensor: self._space(self._measured())})
        self.observation_space = cast("spaces.Space[Observation]", space)

    @property
    def _of(self) -> Any:
        return self.get_wrapper_attr("sim").sensors[self._sensor]

    def _space(self, measured: npt.NDArray[Any]) -> spaces.Box:
        raise NotImplementedError

    def _measured(self) -> npt.NDArray[Any]:
        raise NotImplementedError

    def observation(self, observation: Observation) -> Observation:
        """The observation with what the sensor measured."""
        return {**observation, self._sensor: self._measured()}


class ScanObservation(_SensorObservation):
    """Adds the ranges of a laser scanner: (rings, beams) float32, metres, at most `reach_m`; nothing hit is `reach_m`, too."""

    def __init__(self, env: gymnasium.Env[Observation, Action], sensor: str, *, reach_m: float = 10.0) -> None:
        if not 0 < reach_m < math.inf:
            raise InputError(f"reach_m is {reach_m!r}, expected metres above 0")
        self._reach_m = np.float32(reach_m)
        super().__init__(env, sensor, reach_m=reach_m)

    def _space(self, measured: npt.NDArray[Any]) -> spaces.Box:
        return spaces.Box(0, float(self._reach_m), measured.shape, np.float32)

    def _measured(self) -> npt.NDArray[Any]:
        ranges: npt.NDArray[Any] = np.minimum(self._of.range_m, self._reach_m)
        return ranges


class CameraObservation(_SensorObservation):
    """Adds an image of a camera: "rgb" is (h, w, 3) uint8, another output, such as "depth", is as it was measured."""

    def __init__(self, env: gymnasium.Env[Observation, Action], sensor: str, *, output: str = "rgb") -> None:
        self._output = output
        super().__init__(env, sensor, output=output)

    def _space(self, measured: npt.NDArray[Any]) -> spaces.Box:
        if np.issubdtype(measured.dtype, np.integer):
            limits = np.iinfo(measured.dtype)
            return spaces.Box(limits.min, limits.max, measured.shape, measured.dtype.type)
        return spaces.Box(-np.inf, np.inf, measured.shape, measured.dtype.type)

    def _measured(self) -> npt.NDArray[Any]:
        image: npt.NDArray[Any] = self._of.rgb if self._output == "rgb" else self._of.image(self._output).array.copy()
        return image


def _drive(**settings: Any) -> gymnasium.Env[Observation, Action]:
    return ScanObservation(DriveEnv(**settings), "FRONT_SCANNER")


def _drive_by_camera(**settings: Any) -> gymnasium.Env[Observation, Action]:
    return CameraObservation(DriveEnv(cameras=["ROBOT_CAM"], **settings), "ROBOT_CAM")


def _many_drive_by_camera(num_envs: int, **settings: Any) -> DriveVectorEnv:
    return DriveVectorEnv(num_envs, cameras=["ROBOT_CAM"], **settings)


def register_envs() -> None:
    """Registers simvis/Scene-v0, simvis/Drive-v0 and simvis/DriveByCamera-v0, as the import of this module does."""
    for name, one, many, frames in (("Scene-v0", "SceneEnv", "SceneVectorEnv", None),
                                    ("Drive-v0", "_drive", "DriveVectorEnv", 200),
                                    ("DriveByCamera-v0", "_drive_by_camera", "_many_drive_by_camera", 200)):
        gymnasium.register(f"simvis/{name}", entry_point=f"simvis.gym:{one}", vector_entry_point=f"simvis.gym:{many}",
                           max_episode_steps=frames)


register_envs()
