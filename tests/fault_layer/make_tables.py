#!/usr/bin/env python3
"""Makes the tables of the fault layer from the Vulkan registry:

    tests/fault_layer/make_tables.py /usr/share/vulkan/registry/vk.xml

commands.inc  SIMVIS_COMMAND(FUNCTION, RESULT...): each command with a VkResult, and what else than VK_SUCCESS it may return
objects.inc   SIMVIS_OBJECT(HANDLE, MAKER, DESTROYER): each object of a device that has a function of its own to destroy it
results.inc   SIMVIS_RESULT(RESULT): each result of commands.inc
limits.inc    SIMVIS_LIMIT(NAME): each number of VkPhysicalDeviceLimits

They have the commands of the core versions up to 1.3 and of VK_KHR_swapchain. The files are committed, so a build needs
no registry.
"""
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

VERSIONS = ["VK_VERSION_1_0", "VK_VERSION_1_1", "VK_VERSION_1_2", "VK_VERSION_1_3"]
EXTENSIONS = ["VK_KHR_swapchain"]
# No instance exists yet when these are called, so no layer that a program asks for sees them.
WITHOUT_INSTANCE = ["vkEnumerateInstanceExtensionProperties", "vkEnumerateInstanceLayerProperties",
                    "vkEnumerateInstanceVersion"]
NUMBERS = ["uint32_t", "int32_t", "float", "size_t", "VkDeviceSize"]


def wanted_names(registry):
    blocks = [feature for feature in registry.findall("feature") if feature.get("name") in VERSIONS]
    blocks += [each for each in registry.findall("extensions/extension") if each.get("name") in EXTENSIONS]
    requires = [require for block in blocks for require in block.findall("require")]
    return {command.get("name") for require in requires
            if require.get("extension") is None for command in require.findall("command")}


def commands_of(registry):
    wanted = wanted_names(registry)
    found = {}
    for command in registry.findall("commands/command"):
        name = command.findtext("proto/name")
        if name in wanted and command.get("api", "vulkan") != "vulkansc":
            found[name] = command
    return dict(sorted(found.items()))


def results_of(command):
    results = command.get("successcodes", "").split(",") + command.get("errorcodes", "").split(",")
    return [result for result in results if result not in ("", "VK_SUCCESS")]


def failing(commands):
    for name, command in commands.items():
        if command.findtext("proto/type") == "VkResult" and name not in WITHOUT_INSTANCE and results_of(command):
            yield name, results_of(command)


def command_rows(commands):
    for name, results in failing(commands):
        yield f"SIMVIS_COMMAND({name}, {', '.join(results)})"


def result_rows(commands):
    for result in sorted({result for _, results in failing(commands) for result in results}):
        yield f"SIMVIS_RESULT({result})"


def object_rows(commands):
    """Commands for one object whose last parameter is where they write it, and those that end it."""
    enders = {}
    for name, command in commands.items():
        parameters = command.findall("param")
        if name.startswith(("vkDestroy", "vkFree")) and len(parameters) == 3:
            if parameters[0].findtext("type") == "VkDevice":
                enders[parameters[1].findtext("type")] = name
    for name, command in commands.items():
        last = command.findall("param")[-1].findtext("type")
        if name.startswith(("vkCreate", "vkAllocate")) and last in enders:
            yield f"SIMVIS_OBJECT({last}, {name}, {enders[last]})"


def limit_rows(registry):
    limits = registry.find("types/type[@name='VkPhysicalDeviceLimits']")
    for member in limits.findall("member"):
        if member.findtext("type") in NUMBERS and not (member.find("name").tail or "").startswith("["):
            yield f"SIMVIS_LIMIT({member.findtext('name')})"


def main():
    registry = ElementTree.parse(sys.argv[1]).getroot()
    commands = commands_of(registry)
    folder = pathlib.Path(__file__).resolve().parent
    head = "// Made by make_tables.py from the Vulkan registry.\n"
    for name, rows in [("commands", command_rows(commands)), ("objects", object_rows(commands)),
                       ("results", result_rows(commands)), ("limits", limit_rows(registry))]:
        (folder / f"{name}.inc").write_text(head + "\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
