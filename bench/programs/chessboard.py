"""A chessboard for calibration: its picture, and its corners in pictures."""
import cv2
import numpy as np

import board

COLUMNS, ROWS, SQUARE_M, SQUARE_PX = 9, 6, 0.04, 100  # inner corners


def show(folder, camera):
    """As board.show. Returns the files of the pictures."""
    picture = np.full(((ROWS + 3) * SQUARE_PX, (COLUMNS + 3) * SQUARE_PX), 255, np.uint8)
    for row in range(ROWS + 1):
        for column in range(row % 2, COLUMNS + 1, 2):
            y, x = (row + 1) * SQUARE_PX, (column + 1) * SQUARE_PX
            picture[y:y + SQUARE_PX, x:x + SQUARE_PX] = 0
    cv2.imwrite(str(folder / "board.png"), picture)
    files, _ = board.show(folder, (COLUMNS + 3) * SQUARE_M, (ROWS + 3) * SQUARE_M, camera)
    return files


def find(files):
    """The corners of the pictures with the whole board: in metres, and in pixels."""
    grid = np.zeros((COLUMNS * ROWS, 3), np.float32)
    grid[:, :2] = np.mgrid[0:COLUMNS, 0:ROWS].T.reshape(-1, 2) * SQUARE_M
    seen = []
    for file in files:
        grey = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)
        found, corners = cv2.findChessboardCornersSB(grey, (COLUMNS, ROWS), cv2.CALIB_CB_ACCURACY)
        if found:
            seen.append(corners)
    return [grid] * len(seen), seen


def overlay(file, picture, corners):
    """Draws the corners into a picture."""
    cv2.imwrite(str(file), cv2.drawChessboardCorners(cv2.imread(str(picture))[::2, ::2].copy(), (COLUMNS, ROWS), corners / 2,
                                                     True))
