"""The arm's measures, and the joint angles that bring its gripper to a place.

Joints turn about z, y, y, x, y, x of their links. All angles are in degrees. At zero the upper arm stands upright, the
forearm and the hand point forward along x.
"""
import math

SHOULDER_Z = 0.10   # of the turret, above the base
UPPER_ARM_Z = 0.13  # of the shoulder's axis, above the turret's foot
UPPER_ARM = 0.32    # from shoulder to elbow
FOREARM = 0.20      # from elbow to forearm roll
WRIST = 0.10        # from forearm roll to wrist
HAND = 0.075        # from wrist to hand roll
FINGERS = 0.06      # from hand roll to the fingers' rails
FINGER = 0.07       # length of a finger
GRIP_MAX = 0.04     # how far a finger opens

LIMITS = {"TURRET": (-170, 170), "SHOULDER": (-60, 110), "ELBOW": (-70, 150), "FOREARM_ROLL": (-170, 170),
          "WRIST": (-115, 115), "HAND_ROLL": (-175, 175)}


def reach_down(x, y, z, yaw):
    """Joint angles, in the order of LIMITS, that put the fingers' tips at a place in the arm's base frame.

    The hand points straight down; `yaw` turns the line between the fingers about the vertical.
    """
    tip = HAND + FINGERS + FINGER
    turret = math.degrees(math.atan2(y, x))
    r, h = math.hypot(x, y), z + tip - SHOULDER_Z - UPPER_ARM_Z
    forearm = FOREARM + WRIST
    distance = math.hypot(r, h)
    cosine = (UPPER_ARM ** 2 + distance ** 2 - forearm ** 2) / (2 * UPPER_ARM * distance)
    if not -1 <= cosine <= 1:
        raise ValueError(f"{x} {y} {z} is out of reach")
    shoulder = math.atan2(r, h) - math.acos(cosine)
    elbow_r, elbow_h = UPPER_ARM * math.sin(shoulder), UPPER_ARM * math.cos(shoulder)
    forearm_pitch = math.atan2(elbow_h - h, r - elbow_r)
    shoulder, pitch = math.degrees(shoulder), math.degrees(forearm_pitch)
    roll = (turret - yaw + 90) % 180 - 90  # the gripper looks the same after half a turn
    joints = (turret, shoulder, pitch - shoulder, 0.0, 90 - pitch, roll)
    for (name, (lower, upper)), value in zip(LIMITS.items(), joints):
        if not lower <= value <= upper:
            raise ValueError(f"{name} would be at {value:.1f} degrees")
    return joints
