"""Scenes as vector environments of Gymnasium."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from ._errors import InputError
from ._vector import VectorSimulation

Array = npt.NDArray[Any]
Observations = dict[str, Array]


class SceneVectorEnv(gymnasium.vector.VectorEnv[Observations, Array, Array]):
    """Environments of one scene file that are stepped together: actions set parameters, and then each makes a frame.

    actions        parameters by "ELEMENT.PARAMETER" with the limits of their values, in the units of the element's table
    parameters     parameters whose values are observed; None: those of `actions`
    outputs        what of the sensors is observed, by "SENSOR.OUTPUT": as VectorSimulation.outputs
    sensors        the sensors that measure; None: those of `outputs`
    reward, ended  functions of the VectorSimulation after each frame that return (num_envs,) values; None: 0 and False
    reload         an episode begins with a scene that is loaded again, with a seed of its own, as in SceneEnv. False: it
                   begins with the state of the first one, which is fast; noise of sensors is then that of the first one, too
    max_episode_steps  after so many frames an episode is truncated; None: never
    render_camera  the sensor whose pictures render() returns, with render_mode="rgb_array"
    settings       as of Simulation.load(), without the seeds, which episodes draw from that of reset()

    An environment whose episode has ended ignores the next action and begins another one with the next step
    (AutoresetMode.NEXT_STEP). With `reload`, environment i after reset(seed=s) is that of SceneEnv after reset(seed=s + i).
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 15, "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(self, num_envs: int, scene: str | os.PathLike[str], actions: Mapping[str, tuple[float, float]], *,
                 parameters: Sequence[str] | None = None, outputs: Sequence[str] = (), sensors: Sequence[str] | None = None,
                 reward: Callable[[VectorSimulation], npt.ArrayLike] | None = None,
                 ended: Callable[[VectorSimulation], npt.ArrayLike] | None = None, reload: bool = True,
                 max_episode_steps: int | None = None, render_mode: str | None = None, render_camera: str = "",
                 **settings: Any) -> None:
        if render_mode is not None and (render_mode not in self.metadata["render_modes"] or not render_camera):
            raise InputError(f'render_mode is {render_mode!r}, expected None, or "rgb_array" with render_camera')
        if not actions:
            raise InputError('actions is empty, expected parameters such as {"DRIVE.speed": (0, 1)}')
        self.num_envs: int = num_envs
        self.render_mode: str | None = render_mode
        self._render_camera = render_camera
        self._actions, self._parameters = list(actions), list(actions if parameters is None else parameters)
        self._outputs, self._reward, self._ended, self._reload = list(outputs), reward, ended, reload
        self._limit = max_episode_steps
        seen = [*(name.rpartition(".")[0] for name in outputs)] if sensors is None else list(sensors)
        seen += [render_camera] if render_mode else []
        #: The simulations.
        self.sims: VectorSimulation = VectorSimulation.load(os.path.abspath(scene), num_envs, sensors=seen, **settings)
        self.sims.only(*seen)
        self.sims.step()
        if not reload:
            self.sims.save_states()
        #: The random numbers of each environment, since reset().
        self.randoms: list[np.random.Generator] = []
        self._frames = np.zeros(num_envs, np.int64)
        self._over = np.zeros(num_envs, bool)
        low, high = np.array(list(actions.values()), np.float32).T
        self.single_action_space: spaces.Space[Any] = spaces.Box(low, high)
        self.single_observation_space: spaces.Space[Any] = spaces.Dict(self._spaces())
        self.action_space: spaces.Space[Any] = batch_space(self.single_action_space, num_envs)
        self.observation_space: spaces.Space[Any] = batch_space(self.single_observation_space, num_envs)

    def begin(self, environments: Sequence[int]) -> None:
        """Called before the first frame of an episode of these, to draw a start by self.randoms[i]. Does nothing."""

    def apply(self, actions: Array, acting: npt.NDArray[np.bool_]) -> None:
        """Sets the parameters of the actions in the environments that are acting."""
        for column, name in enumerate(self._actions):
            self.sims.parameters[name] = np.where(acting, actions[:, column], self.sims.parameters[name])

    def reset(self, *, seed: int | Sequence[int | None] | None = None,
              options: dict[str, Any] | None = None) -> tuple[Observations, dict[str, Any]]:
        """Begins an episode in each environment. The same seed gives the same episodes."""
        seeds = list(seed) if isinstance(seed, Sequence) else [None if seed is None else seed + i for i in range(self.num_envs)]
        if len(seeds) != self.num_envs:
            raise InputError(f"there are {len(seeds)} seeds, expected {self.num_envs}")
        before = self.randoms
        self.randoms = [before[i] if before and each is None else seeding.np_random(each)[0] for i, each in enumerate(seeds)]
        self._begin(list(range(self.num_envs)))
        self.sims.step()
        return self._observations(), self._info()

    def _begin(self, environments: list[int]) -> None:
        if self._reload:
            self.sims.reload([int(self.randoms[i].integers(1 << 32)) for i in environments], environments)
            self.sims.step_some(environments)
        else:
            self.sims.restore_states(environments)
        self.begin(environments)
        self._frames[environments] = 0
        self._over[environments] = False

    def step(self, actions: Array) -> tuple[Observations, Array, Array, Array, dict[str, Any]]:
        """Sets the parameters, makes a frame of each environment and returns what was measured."""
        if not self.randoms:
            raise gymnasium.error.ResetNeeded("expected reset() before step()")
        acting = ~self._over
        if not acting.all():
            self._begin([int(i) for i in np.flatnonzero(~acting)])
        self.apply(np.asarray(actions), acting)
        self.sims.step()
        self._frames += acting
        reward = self._values(self._reward, np.float64) * acting
        ended = self._values(self._ended, np.bool_) & acting
        truncated = acting & (self._frames >= (self._limit or np.iinfo(np.int64).max))
        self._over = ended | truncated
        return self._observations(), reward, ended, truncated, self._info()

    def _values(self, function: Callable[[VectorSimulation], npt.ArrayLike] | None, kind: type[Any]) -> Array:
        values = np.zeros(self.num_envs, kind) if function is None else np.asarray(function(self.sims), kind)
        if values.shape != (self.num_envs,):
            raise InputError(f"{function!r} returned the shape {values.shape}, expected ({self.num_envs},)")
        return values

    def _info(self) -> dict[str, Any]:
        return {"frames": self._frames.copy(), "_frames": np.ones(self.num_envs, bool)}

    def _observations(self) -> Observations:
        parameters = np.stack([self.sims.parameters[name] for name in self._parameters], 1).astype(np.float32)
        return {"parameters": parameters, **{name: np.array(self.sims.outputs[name]) for name in self._outputs}}

    def _spaces(self) -> dict[str, spaces.Space[Any]]:
        return {name: _space(array) for name, array in self._observations().items()}

    def render(self) -> tuple[Any, ...] | None:
        """The pictures of `render_camera`, each (h, w, 3) uint8; None without a render_mode."""
        return tuple(self.sims.outputs[f"{self._render_camera}.rgb"]) if self.render_mode else None

    def close_extras(self, **settings: Any) -> None:
        """Ends the simulations."""
        self.sims.close()


def _space(array: Array) -> spaces.Box:
    if np.issubdtype(array.dtype, np.integer):
        limits = np.iinfo(array.dtype)
        return spaces.Box(limits.min, limits.max, array.shape[1:], array.dtype.type)
    return spaces.Box(-np.inf, np.inf, array.shape[1:], array.dtype.type)
