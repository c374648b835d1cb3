"""A board with a printed picture that is shown to a camera, from many sides."""
import numpy as np

import trial

WIDTH, HEIGHT = 640, 480
VIEWS = 20
THICKNESS_M = 0.002


def write_poses(file, views):
    """Poses of the board before the camera: over the whole picture, and leaning up to 35 degrees."""
    random = np.random.default_rng(1)
    lines = ["time_s,BOARD_POSE.x,BOARD_POSE.y,BOARD_POSE.z,BOARD_POSE.roll,BOARD_POSE.pitch,BOARD_POSE.yaw"]
    for view in range(views):
        x = random.uniform(0.5, 0.8)
        y, z = random.uniform(-0.25, 0.25) * x, random.uniform(-0.18, 0.18) * x
        roll, pitch, yaw = random.uniform(-35, 35, 3)
        lines.append(f"{view / 10},{x},{y},{z},{roll / 3},{pitch},{yaw}")
    file.write_text("\n".join(lines) + "\n")


def show(folder, width_m, height_m, camera, views=VIEWS):
    """Shows the picture folder/board.png of this size to a camera with these attributes. Returns the files of its pictures, and
    the poses of the board's middle in the camera: x to the right of the board, y down, z into it. The light leaves white below
    1: where pictures are overexposed, black shapes are too small."""
    write_poses(folder / "views.csv", views)
    out = trial.simvis_run(f"""
  <element type="sky" name="SKY" insert_at="ROOT" red="0.3" green="0.3" blue="0.3" ambient_red="0.6" ambient_green="0.6"
           ambient_blue="0.6"/>
  <part name="BOARD" insert_at="ROOT" shape="box" size="{THICKNESS_M} {width_m} {height_m}" texture="board.png"/>
  <element type="pose" name="BOARD_POSE" insert_at="BOARD"/>
  <sensor type="camera" name="CAM" insert_at="ROOT" width="{WIDTH}" height="{HEIGHT}" {camera}/>""", folder,
                           "--trajectory", folder / "views.csv", "--rate", 10, "--poses", "BOARD")
    front = trial.OPTICAL.copy()
    front[0, 3] = -THICKNESS_M / 2
    return sorted(out.glob("CAM/*.png")), np.linalg.inv(trial.OPTICAL) @ trial.rigid(out / "BOARD_poses.tum") @ front


def pinhole(hfov_deg):
    """The camera matrix, which counts pixels from the centre of the first."""
    focal_px = WIDTH / 2 / np.tan(np.radians(hfov_deg / 2))
    return np.array([[focal_px, 0, (WIDTH - 1) / 2], [0, focal_px, (HEIGHT - 1) / 2], [0, 0, 1]])
