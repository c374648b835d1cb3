"""Whether the files beside a generator are what it makes."""
import gltf_writer


def problems(folder, files, made=("*.glb",)):
    """Messages about files of a folder that differ from `files`, bytes by name, or that match one of the patterns
    `made` and are not among them. Binary glTF is compared by content: compressed pictures may differ from one zlib to
    another."""
    messages = []
    for name, data in files.items():
        path = folder / name
        if not path.exists():
            messages.append(f"{name} is missing")
            continue
        found = path.read_bytes()
        same = gltf_writer.content(found) == gltf_writer.content(data) if name.endswith(".glb") else found == data
        if not same:
            messages.append(f"{name} is not what generate.py makes")
    known = {folder / name for name in files}
    messages += [f"{path.name} is not made by generate.py" for pattern in made
                 for path in sorted(folder.glob(pattern)) if path not in known]
    return messages
