"""OpenCV: a camera with a lens is calibrated from pictures of a chessboard.

packages: opencv-contrib-python-headless==4.12.0.88 numpy==2.2.6
"""
import time

import cv2
import numpy as np

import trial

COLUMNS, ROWS, SQUARE_M, SQUARE_PX = 9, 6, 0.04, 100  # inner corners
WIDTH, HEIGHT, HFOV_DEG = 640, 480, 70
LENS = {"k1": -0.28, "k2": 0.09, "p1": 0.0006, "p2": -0.0004, "k3": -0.01}
VIEWS = 20


def draw_board(file):
    board = np.full(((ROWS + 3) * SQUARE_PX, (COLUMNS + 3) * SQUARE_PX), 255, np.uint8)
    for row in range(ROWS + 1):
        for column in range(COLUMNS + 1):
            if (row + column) % 2 == 0:
                y, x = (row + 1) * SQUARE_PX, (column + 1) * SQUARE_PX
                board[y:y + SQUARE_PX, x:x + SQUARE_PX] = 0
    cv2.imwrite(str(file), board)


def write_views(file):
    """Poses of the board before the camera: over the whole picture, and leaning up to 35 degrees."""
    random = np.random.default_rng(1)
    lines = ["time_s,BOARD_POSE.x,BOARD_POSE.y,BOARD_POSE.z,BOARD_POSE.roll,BOARD_POSE.pitch,BOARD_POSE.yaw"]
    for view in range(VIEWS):
        x = random.uniform(0.5, 0.8)
        y, z = random.uniform(-0.25, 0.25) * x, random.uniform(-0.18, 0.18) * x
        roll, pitch, yaw = random.uniform(-35, 35, 3)
        lines.append(f"{view / 10},{x},{y},{z},{roll / 3},{pitch},{yaw}")
    file.write_text("\n".join(lines) + "\n")


def measure(folder):
    draw_board(folder / "board.png")
    write_views(folder / "views.csv")
    lens = " ".join(f'{name}="{value}"' for name, value in LENS.items())
    size = f"0.002 {(COLUMNS + 3) * SQUARE_M} {(ROWS + 3) * SQUARE_M}"
    out = trial.simvis_run(f"""
  <element type="sky" name="SKY" insert_at="ROOT" red="0.3" green="0.3" blue="0.3" ambient_red="2" ambient_green="2"
           ambient_blue="2"/>
  <part name="BOARD" insert_at="ROOT" shape="box" size="{size}" texture="board.png"/>
  <element type="pose" name="BOARD_POSE" insert_at="BOARD"/>
  <sensor type="camera" name="CAM" insert_at="ROOT" width="{WIDTH}" height="{HEIGHT}" hfov="{HFOV_DEG}"
          distortion="brown_conrady" {lens} supersampling="16"/>""", folder,
                            "--trajectory", folder / "views.csv", "--rate", 10)
    begin = time.monotonic()
    grid = np.zeros((COLUMNS * ROWS, 3), np.float32)
    grid[:, :2] = np.mgrid[0:COLUMNS, 0:ROWS].T.reshape(-1, 2) * SQUARE_M
    seen = []
    for picture in sorted(out.glob("CAM/*.png")):
        grey = cv2.imread(str(picture), cv2.IMREAD_GRAYSCALE)
        found, corners = cv2.findChessboardCornersSB(grey, (COLUMNS, ROWS), cv2.CALIB_CB_ACCURACY)
        if found:
            seen.append(corners)
    rms_px, matrix, found_lens, *_ = cv2.calibrateCamera([grid] * len(seen), seen, (WIDTH, HEIGHT), None, None)
    seconds = time.monotonic() - begin
    focal_px = WIDTH / 2 / np.tan(np.radians(HFOV_DEG / 2))
    true = np.array([[focal_px, 0, (WIDTH - 1) / 2], [0, focal_px, (HEIGHT - 1) / 2], [0, 0, 1]])
    return [("boards found", len(seen), f"of {VIEWS}", seconds), ("reprojection, RMS", rms_px, "px", seconds),
            ("focal length", abs(matrix[0, 0] - focal_px), "px", seconds),
            ("principal point", np.hypot(*(matrix[:2, 2] - true[:2, 2])), "px", seconds),
            ("lens where boards were seen, largest", lens_error_px(np.concatenate(seen), matrix, found_lens, true),
             "px", seconds)]


def lens_error_px(pixels, matrix, lens, true_matrix):
    """The largest difference of the two models over the rays of these pixels."""
    pixels = pixels.astype(float)
    true_lens = np.array([LENS[name] for name in ("k1", "k2", "p1", "p2", "k3")])
    rays = cv2.undistortPointsIter(pixels, true_matrix, true_lens, np.eye(3), np.eye(3), (3, 100, 1e-12))
    points = np.concatenate([rays, np.ones((len(rays), 1, 1))], -1)
    projected, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, lens)
    return np.abs(projected - pixels).max()


trial.main(measure)
