"""Labels of semantics as elements `label`."""

import zlib
from xml.sax.saxutils import quoteattr


def class_of(prim):
    """The class that a prim itself has, by UsdSemantics or by the schema that came before it; None: it has none."""
    for attribute in prim.GetAuthoredAttributes():
        name = attribute.GetName()
        value = attribute.Get()
        if name.startswith("semantics:labels:") and value is not None and len(value):
            return str(value[0])
        if name.startswith("semantic:") and name.endswith(":semanticData") and value:
            kind = prim.GetAttribute(name[: -len("semanticData")] + "semanticType").Get()
            if kind in (None, "class"):
                return str(value)
    return None


def number_of(name):
    """The same number for a class in every file."""
    return 1 + zlib.crc32(name.encode()) % 65535


def label_commands(stage):
    """One element for each insertion point with a class, its own or that of the nearest prim above.

    A labelled prim is one object with all that stands below it, unless another label or a joint is below it: the nodes
    of what is jointed stand elsewhere.
    """
    commands, wholes = [], []
    labelled = [path for path, own, _ in stage.classes.values() if own is not None]
    for point, (path, own, kind) in stage.classes.items():
        if any(path.HasPrefix(whole) for whole in wholes):
            continue
        others = [*labelled, *stage.physics.above]
        is_whole = kind == "simvis_models" and not any(p != path and p.HasPrefix(path) for p in others)
        if is_whole:
            wholes.append(path)
        label = own
        above = path
        while label is None and not above.IsAbsoluteRootPath():
            above = above.GetParentPath()
            prim = stage.stage.GetPrimAtPath(above)
            label = class_of(prim) if prim else None
        if label is not None:
            commands.append(
                f"<element type=\"label\" name={quoteattr(point + ' class')} insert_at={quoteattr(point)} "
                f'class={quoteattr(label)} class_id="{number_of(label)}"' + (' level="model"/>' if is_whole else "/>")
            )
    return commands
