"""Matrices of USD, whose vectors are rows, as matrices of columns in metres."""

import numpy


def columns(matrix, metres):
    """A matrix of USD, whose vectors are rows, with lengths in metres."""
    made = numpy.array(matrix, dtype=float).reshape(4, 4).T.copy()
    made[:3, 3] *= metres
    return made


def rigid_part(matrix):
    """Rotation and translation, without scale and shear."""
    made = numpy.eye(4)
    u, _, v = numpy.linalg.svd(matrix[:3, :3])
    made[:3, :3] = u @ numpy.diag([1, 1, numpy.linalg.det(u @ v)]) @ v
    made[:3, 3] = matrix[:3, 3]
    return made
