"""Starts a simulation as a node of ROS 2, with its services.

    ros2 launch simvis simvis.launch.py scene:=/path/to/scene.xml params_file:=/path/to/simvis.yaml
"""
import shlex

import yaml
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration

# Name, default (None: it must be given), description.
ARGUMENTS = (
    ("scene", None, "scene file"),
    ("node", "simvis", "name of the node, NAME or /NAMESPACE/NAME"),
    ("params_file", "", "values of parameters as a ROS parameter file"),
    ("real_time", "1", "simulated seconds for each second; 0: as fast as possible"),
    ("requests", "true", "whether services and requests may change the scene and control the run"),
    ("live", "false", "whether a page in the browser shows the run"),
    ("options", "", "further options of simvis-run"),
)


def values_in(tree, prefix=""):
    """Yields name and value of each parameter of a node in a parameter file: nested names are joined by dots."""
    for name, value in tree.items():
        if isinstance(value, dict):
            yield from values_in(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def parameters_in(text, node):
    """Returns the parameters that a parameter file has for a node, by name."""
    full_name = node if node.startswith("/") else "/" + node
    found = {}
    for key, content in (yaml.safe_load(text) or {}).items():
        if key in ("/**", full_name, full_name.lstrip("/")):
            found.update(values_in((content or {}).get("ros__parameters") or {}))
    return {name: value for name, value in found.items() if "." in name}  # not those of ROS, such as use_sim_time


def command(arguments):
    """Returns the command line for values of ARGUMENTS, by name."""
    line = ["simvis-run", "--dds", "--dds-node", arguments["node"]]
    if float(arguments["real_time"]) > 0:
        line += ["--real-time", arguments["real_time"]]
    if arguments["requests"].lower() == "true":
        line.append("--dds-requests")
    if arguments["live"].lower() == "true":
        line.append("--live")
    if arguments["params_file"]:
        with open(arguments["params_file"], encoding="utf-8") as file:
            parameters = parameters_in(file.read(), arguments["node"])
        for name, value in parameters.items():
            line += ["--set", f"{name}={value}"]
    return [*line, *shlex.split(arguments["options"]), "--", arguments["scene"]]


def start(context):
    values = {name: LaunchConfiguration(name).perform(context) for name, _, _ in ARGUMENTS}
    return [ExecuteProcess(cmd=command(values), output="screen")]


def generate_launch_description():
    arguments = [
        DeclareLaunchArgument(name, default_value=default, description=description)
        for name, default, description in ARGUMENTS
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=start)])
