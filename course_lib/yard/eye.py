"""The drone's camera: draws the yard from a pose, without a display."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from course_lib.yard import backend, model
from course_lib.yard.lens import SIZE
from course_lib.yard.scene import WELL

if TYPE_CHECKING:
    from numpy.typing import NDArray

# MuJoCo's cameras look along -z with y up; OpenCV's along +z with y down.
MUJOCO_FROM_OPENCV = np.diag([1.0, -1.0, -1.0])

# An OpenGL context belongs to one thread, and JupyterLab answers widgets from another one than
# runs the cells. So one thread draws for all.
_DRAWING = ThreadPoolExecutor(1, thread_name_prefix="drone-eye")


@cache
def yard_model() -> Any:  # noqa: ANN401 (MuJoCo has no types)
    """Return the yard's model, built once in a process: it never changes."""
    mujoco, _ = backend.load()
    return model.build(mujoco)


class Eye:
    """An OpenGL context with the yard in it.

    Raises
    ------
    RendererError
        There is nothing to draw with; the message says what to install.
    """

    def __init__(self) -> None:
        self._mujoco, make_context = backend.load()
        self._context: Any = None
        _DRAWING.submit(self._open, make_context).result()

    def _open(self, make_context: Any) -> None:  # noqa: ANN401
        mujoco, yard = self._mujoco, yard_model()
        self._data = mujoco.MjData(yard)
        self._context = make_context(*SIZE)
        self._context.make_current()
        self._drawer = mujoco.MjrContext(yard, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._drawer)
        self._scene = mujoco.MjvScene(yard, yard.ngeom + 10)
        for flag in ("SHADOW", "REFLECTION", "HAZE"):
            self._scene.flags[getattr(mujoco.mjtRndFlag, f"mjRND_{flag}")] = False
        self._options = mujoco.MjvOption()
        self._options.geomgroup[:] = [group == model.SEEN for group in range(6)]
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self._camera.fixedcamid = yard.camera("front").id
        self._rectangle = mujoco.MjrRect(0, 0, *SIZE)
        self._pixels = np.empty((SIZE[1], SIZE[0], 3), np.uint8)

    def _draw(self, T_camera_from_world: NDArray[np.float64]) -> NDArray[np.uint8]:
        if self._context is None:
            raise ValueError("this camera is closed")
        mujoco, yard, data = self._mujoco, yard_model(), self._data
        R, t = T_camera_from_world[:3, :3], T_camera_from_world[:3, 3]
        data.mocap_pos[0] = -R.T @ t
        mujoco.mju_mat2Quat(data.mocap_quat[0], (R.T @ MUJOCO_FROM_OPENCV).ravel())
        mujoco.mj_kinematics(yard, data)
        mujoco.mj_camlight(yard, data)
        self._context.make_current()
        every = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(yard, data, self._options, None, self._camera, every, self._scene)
        mujoco.mjr_render(self._rectangle, self._scene, self._drawer)
        mujoco.mjr_readPixels(self._pixels, None, self._rectangle, self._drawer)
        return self._pixels

    def look(self, T_camera_from_world: NDArray[np.float64]) -> NDArray[np.uint8]:
        """Draw what the camera sees.

        Parameters
        ----------
        T_camera_from_world : ndarray, shape (4, 4)
            OpenCV's axes: x right, y down, z forward.

        Returns
        -------
        ndarray of uint8, shape (480, 640, 3)
            BGR.
        """
        # OpenGL's rows begin at the bottom.
        upright = cv2.flip(_DRAWING.submit(self._draw, T_camera_from_world).result(), 0)
        return np.asarray(cv2.cvtColor(upright, cv2.COLOR_RGB2BGR), np.uint8)

    def well_mask(self, T_camera_from_world: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Tell which pixels show the well, by the renderer's own account.

        Parameters
        ----------
        T_camera_from_world : ndarray, shape (4, 4)

        Returns
        -------
        ndarray of bool, shape (480, 640)
            Nothing stands in front of it: all else is left out.
        """
        yard = yard_model()
        hidden = [i for i in range(yard.ngeom) if not yard.geom(i).name.startswith(WELL)]
        groups = yard.geom_group[hidden].copy()
        flags = self._mujoco.mjtRndFlag
        yard.geom_group[hidden] = model.SOLID
        self._scene.flags[flags.mjRND_SEGMENT] = True
        try:
            drawn = _DRAWING.submit(self._draw, T_camera_from_world).result()
            return np.asarray(np.flipud(drawn.any(axis=2)).copy())
        finally:
            yard.geom_group[hidden] = groups
            self._scene.flags[flags.mjRND_SEGMENT] = False

    def close(self) -> None:
        """Free the context; may be called again."""
        if self._context is not None:
            _DRAWING.submit(self._free).result()

    def _free(self) -> None:
        self._context.make_current()
        self._drawer.free()
        self._context.free()
        self._context = None
