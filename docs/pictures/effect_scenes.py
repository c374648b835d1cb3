"""What the pictures of effects show: for each effect a scene that makes it visible, off and on."""
from dataclasses import dataclass

YARD = """
<part file="showcase/yard.glb" name="YARD" insert_at="ROOT"/>
<part file="showcase/ball.glb" name="BALL" insert_at="YARD" pose_offset="1.4 0.5 1.1 0 0 0"/>
<part file="showcase/fence.glb" name="FENCE" insert_at="YARD" pose_offset="0.6 2.2 0 0 0 -20"/>
<part file="showcase/pane.glb" name="PANE" insert_at="YARD" pose_offset="0.9 -2.75 0 0 0 12"/>
<part file="showcase/sails.glb" name="SAILS" insert_at="YARD" pose_offset="-0.4 -0.65 0 0 0 0"/>
<part file="showcase/mirror.glb" name="MIRROR" insert_at="YARD" pose_offset="3.2 -2.0 0 0 0 -14"/>
<part file="showcase/sign.glb" name="SIGN" insert_at="YARD" pose_offset="2.55 1.2 2.0 0 0 0"/>
<element type="sky" name="SKY" insert_at="ROOT" red="0.42" green="0.6" blue="0.86"
         ambient_red="0.30" ambient_green="0.33" ambient_blue="0.38"/>
"""
SUN = """<element type="light" name="SUN" insert_at="ROOT" intensity="2.6" red="1" green="0.95" blue="0.86"
                  azimuth="{azimuth}" elevation="{elevation}" {more}/>"""
DAYLIGHT = SUN.format(azimuth=-142, elevation=38, more="")

# A corner of the laboratory. The scanner looks along +x at the wall, 3 m away.
ROOM = """
<part file="marvin/laboratory.glb" name="ROOM" insert_at="ROOT"/>
<part file="marvin/cardboard_box.glb" name="BOX" insert_at="ROOM" pose_offset="4.6 2.35 0 0 0 25"/>
<part file="marvin/waste_bin.glb" name="BIN" insert_at="ROOM" pose_offset="5.45 1.5 0 0 0 0"/>
<part file="marvin/visitor_chair.glb" name="CHAIR" insert_at="ROOM" pose_offset="4.9 0.5 0 0 0 140"/>
"""
ROOM_SCANNER = (3, 1.5, 0.2)
ROOM_VIEW = (-0.3, 3.4, -1.25, 3.2)
YARD_SCANNER = (-3, 0, 0.7)

HALF_CIRCLE = 'samples="{}" min_angle="-90" max_angle="90"'


@dataclass
class CameraPicture:
    """`off` and `on`: commands that the scene gets, and attributes that the camera gets."""
    effect: str
    caption: str
    scene: str = YARD + DAYLIGHT
    pose: tuple = (-5.2, -0.6, 1.9, 10, 4)  # x y z in metres, pitch and yaw in degrees
    hfov: float = 58
    off: tuple = ("", "")
    on: tuple = ("", "")
    crop: tuple = ()     # left, top, width, height in pixels of what is magnified
    frames: int = 1
    trajectory: str = ""


@dataclass
class ScanPicture:
    """`off` and `on`: commands that the scene gets, and attributes that the scanner gets."""
    effect: str
    caption: str
    scene: str = ROOM
    place: tuple = ROOM_SCANNER
    beams: str = HALF_CIRCLE.format(361)
    view: tuple = ROOM_VIEW  # least x, greatest x, least y, greatest y in metres, in the sensor's frame
    off: tuple = ("", "")
    on: tuple = ("", "")
    labels: tuple = ("off", "on")
    color_by: str = ""
    color_range: tuple = ()
    names: tuple = ()        # (x, y, text): what stands where
    names_on: tuple = ()     # further ones of the right panel
    marks_lost: bool = False
    overlaid: int = 1        # scans of as many frames
    frames: int = 1
    trajectory: str = ""


# Trajectories of the element HEAD, which carries the sensor, from the first frame to the second, which is shown.
PANNING = "time_s,HEAD.yaw\n0,-3\n0.066666667,4\n"
DRIVING = "time_s,HEAD.x,HEAD.yaw\n0,2.8,-14\n0.066666667,3,0\n"

NEAR_BALL = '<part file="showcase/ball.glb" name="NEAR_BALL" insert_at="ROOT" pose_offset="-1.5 -0.4 1 0 0 0"/>'
SPHERES = '<part file="showcase/{}.glb" name="SPHERES" insert_at="ROOT" pose_offset="-1.4 0 0.6 0 0 0"/>'
PLATE = '<part file="showcase/{}.glb" name="PLATE" insert_at="ROOT" pose_offset="-2.1 0.4 1 0 0 0"/>'
LOW_SUN = {"azimuth": -112, "elevation": 32}

CAMERA = [
    CameraPicture("exposure", "twice the light: all is brighter, the sky clips to white", on=("", 'exposure="2"')),
    CameraPicture("fog", "distant surfaces fade into the light of the air",
                  on=('<element type="fog" name="FOG" insert_at="ROOT" visibility="40"/>', "")),
    CameraPicture("lens_distortion", "straight edges bend",
                  on=("", 'distortion="brown_conrady" k1="-0.32" k2="0.08" lens_oversampling="2"')),
    CameraPicture("vignetting", "the picture of a wide lens is darker towards its corners", hfov=84,
                  pose=(-4.2, -0.4, 1.7, 8, 4), on=("", 'vignetting="natural"')),
    CameraPicture("rolling_shutter", "the camera pans and exposes row after row: uprights lean",
                  on=("", 'row_time="3.1e-4" rows_per_pose="1"'), frames=2, trajectory=PANNING),
    CameraPicture("sensor_noise", "300 electrons in a full pixel: grain (white frame, magnified)",
                  on=("", 'full_well_e="300" read_noise_e="6" adc_bits="8"'), crop=(130, 62, 40, 26)),
    CameraPicture("shadows", "ball, posts and sheets cast shadows", scene=YARD, pose=(-4.4, -0.3, 2.0, 16, 4),
                  off=(SUN.format(**LOW_SUN, more=""), ""),
                  on=(SUN.format(**LOW_SUN, more='shadows="yes" shadow_resolution="4096"'), "")),
    CameraPicture("area_lights", "a lamp with a size: soft shadows", scene=YARD, pose=(-4.4, -0.3, 2.0, 16, 4),
                  off=(SUN.format(**LOW_SUN, more='shadows="yes" shadow_resolution="2048"'), ""),
                  on=(SUN.format(**LOW_SUN, more='shadows="yes" shadow_resolution="2048" angular_radius="4" '
                                                 'lamp_points="64"'), "")),
    CameraPicture("motion_blur", "the camera pans during the exposure", on=("", 'exposure_time="0.04" motion_samples="32"'),
                  frames=2, trajectory=PANNING),
    CameraPicture("depth_of_field", "a wide lens is sharp at one distance", scene=YARD + DAYLIGHT + NEAR_BALL,
                  pose=(-3.9, -0.5, 1.5, 9, 0), on=("", 'aperture="0.08" focus_distance="2.4" lens_samples="64"')),
    CameraPicture("chromatic_aberration", "coloured edges far from the middle (white frame, magnified)", hfov=84,
                  pose=(-4.2, -0.4, 1.7, 8, 4), on=("", 'color_magnification="1.03 1 0.97"'), crop=(262, 30, 48, 32)),
    CameraPicture("transparency", "the sheets are seen through the near ball", scene=YARD + DAYLIGHT + NEAR_BALL,
                  pose=(-3.9, -0.5, 1.5, 9, 0),
                  on=('<element type="material" name="GLASS" insert_at="ROOT" part="NEAR_BALL" opacity="0.5"/>', "")),
    CameraPicture("metallic_roughness", "metal (top) and paint (bottom), from polished to rough",
                  pose=(-4.2, 0, 1.0, 5, 0), hfov=50, off=(SPHERES.format("metal_matte"), ""),
                  on=(SPHERES.format("metal"), "")),
    CameraPicture("normal_maps", "a flat plate is shaded as if it had bumps", pose=(-4.3, 0.1, 1.3, 8, 6), hfov=50,
                  off=(PLATE.format("relief_flat"), ""), on=(PLATE.format("relief"), "")),
]

SCANNER_ERRORS = [
    ScanPicture("range_noise", "30 scans overlaid: hits scatter along their beams", beams=HALF_CIRCLE.format(61),
                view=(0.9, 3.25, -0.7, 1.6), on=("", 'range_noise="0.03"'), overlaid=30, frames=30),
    ScanPicture("angular_noise", "30 scans overlaid: beams stray, so slanted walls blur and edges jump",
                beams=HALF_CIRCLE.format(61), view=(1.0, 3.3, 0.95, 3.25), on=("", 'angular_noise="0.7"'), overlaid=30, frames=30),
    ScanPicture("range_resolution", "ranges in steps of 10 cm: a straight wall breaks into arcs",
                beams=HALF_CIRCLE.format(721), view=(1.75, 3.25, 1.75, 3.25), on=("", 'range_resolution="0.1"')),
    ScanPicture("dropout", "a quarter of the beams has no range (rings)", beams=HALF_CIRCLE.format(121),
                on=("", 'dropout="0.25"'), marks_lost=True),
    ScanPicture("sweep_motion", "the robot drives and turns by 14° during the sweep: walls bend",
                view=(-0.3, 3.9, -1.25, 3.7), on=("", 'sweep="0.066666667"'), frames=2, trajectory=DRIVING),
    ScanPicture("atmosphere", "dense fog: echoes of the air (arcs) where surfaces give weaker ones",
                on=('<element type="fog" name="FOG" insert_at="ROOT" visibility="20"/>', "")),
]

ROUND_SIGN = '<part file="showcase/sign.glb" name="ROUND_SIGN" insert_at="ROOT" pose_offset="5.2 0.6 0.2 0 0 0"/>'
TURNED_MIRROR = '<part file="showcase/mirror.glb" name="MIRROR" insert_at="ROOT" pose_offset="5.1 1.5 -0.3 0 0 -40"/>'
WIDE_BEAMS = 'samples="721" min_angle="-60" max_angle="60" divergence="0.3" divergence_samples="64"'

SCANNER_LIGHT = [
    ScanPicture("intensity", "colour by received power: near, bright, square-on surfaces lead",
                scene=YARD, place=YARD_SCANNER, beams='samples="721" min_angle="-60" max_angle="60"',
                view=(1.6, 7.1, -3.6, 3.6), on=("", 'intensity="on"'), color_by="intensity", color_range=(1e-3, 1e-1),
                names=((2.6, -1.5, "sheets"), (2.9, 2.5, "fence"), (5.0, 0.45, "pillar"), (6.0, -1.0, "wall"),
                       (5.9, -3.0, "bin"))),
    ScanPicture("retro_reflection", "with retro-reflective foil the road sign returns a thousand times the light",
                scene=ROOM + ROUND_SIGN, off=("", 'intensity="on"'),
                on=('<element type="material" name="FOIL" insert_at="ROOT" part="ROUND_SIGN" retro_reflectance="500"/>',
                    'intensity="on"'), color_by="intensity", color_range=(1e-2, 1e2), names=((2.5, -0.9, "sign"),)),
    ScanPicture("returns", "a wire fence splits beams: the first return, or the last",
                scene=YARD, place=YARD_SCANNER, beams=WIDE_BEAMS, view=(2.6, 7, 0, 4), labels=("first", "last"),
                off=("", 'return="first" pulse_length="0.3"'), on=("", 'return="last" pulse_length="0.3"'),
                names=((3.1, 2.4, "fence"), (5.0, 2.4, "crate"), (6.2, 2.0, "wall"), (4.6, 0.5, "pillar"))),
    ScanPicture("beam_divergence", "wide beams: hits between the bin's edge and the wall",
                beams=HALF_CIRCLE.format(1441), view=(2.15, 3.2, -0.5, 0.55),
                on=("", 'divergence="1.5" divergence_samples="64"'), names=((2.45, 0.02, "bin"), (2.8, 0.45, "wall"))),
    ScanPicture("specular_path", "beams go on from a mirror: the box and the walls appear a second time, behind it",
                scene=ROOM + TURNED_MIRROR, beams=HALF_CIRCLE.format(721), view=(-0.3, 6.3, -1.7, 3.2),
                on=('<element type="material" name="SILVER" insert_at="ROOT" part="MIRROR" mirror="1"/>',
                    'path_depth="4"'), names=((1.0, 0.75, "box"), (1.6, -0.1, "mirror"), (2.6, 2.6, "walls")),
                names_on=((3.7, -0.4, "box again"), (4.3, 0.4, "walls again"))),
]
