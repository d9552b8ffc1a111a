"""RG6xx: the scene."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
    # -- glTF files (`where` is the file and the JSON path in it)
    "RG601": Message("error", "{where}: cannot read {path}: {reason}", "check the path and its permissions"),
    "RG602": Message(
        "error",
        "{where}: not a glTF 2.0 file: {reason}",
        "export the scene again as glTF 2.0, .glb or .gltf",
        "A .glb file is a 12-byte header ('glTF', version 2, length) and chunks, the first of them JSON; a "
        ".gltf file is "
        "UTF-8 JSON. A file cut short by a failed download or copy fails here.",
    ),
    "RG603": Message("error", "{where}: invalid JSON: {reason}", "repair the file, or export the scene again"),
    "RG604": Message(
        "error", "{where}: expected {expected}, got {got}", "repair that value, or export the scene again"
    ),
    "RG605": Message("error", "{where}: '{name}' is missing", "add it, or export the scene again"),
    "RG606": Message(
        "error", "{where}: there is no {what}/{index} (the file has {count})", "point it at an element that exists"
    ),
    "RG607": Message(
        "error",
        "{where}: needs bytes {start} to {end}, but {what} has {size}",
        "the file is damaged or was cut short: export the scene again",
    ),
    "RG608": Message(
        "error", "{where}: {got} cannot be used here", "glTF allows {expected} here; export the scene again"
    ),
    "RG609": Message(
        "error",
        "{where}: element {element} is {value}, but there are only {count} {what}",
        "the file is damaged: export the scene again",
    ),
    "RG610": Message(
        "error",
        "{where}: element {element} is not a usable number ({value})",
        "values must be finite and below {limit:g}: repair the geometry in the modelling tool and export again",
    ),
    "RG611": Message(
        "error",
        "{where}: the URI '{uri}' is not allowed: {reason}",
        "keep every file of the scene in its folder or below and use relative URIs",
        "A scene file may come from anywhere; it may name only files next to it or below, never absolute paths, other "
        "schemes than data:, or links that lead out of the folder.",
    ),
    "RG612": Message(
        "error",
        "{where}: {what} needs the extension {extension}, which is not supported",
        "export without it; supported: {supported}",
    ),
    "RG613": Message("error", "{where}: cannot decode the image: {reason}", "replace the image by a sound PNG or JPEG"),
    "RG614": Message(
        "error",
        "{where}: {what} has {pixels} pixels, more than the limit of {limit}",
        "scale the image down",
        "The limit is checked before decoding, so that a small file cannot claim gigabytes of memory.",
    ),
    "RG615": Message(
        "error",
        "{where}: the node hierarchy is not a forest: {reason}",
        "give every node at most one parent and no node itself as an ancestor",
    ),
    "RG616": Message("error", "{where}: {reason}", "see the glTF 2.0 specification, {section}"),
    "RG617": Message(
        "error", "{where}: {what}: {count}, more than the limit of {limit}", "split or simplify the scene"
    ),
    "RG650": Message(
        "error",
        "there is no scene '{source}'",
        "{hint}",
        "A scene is one that ships with the package, by its name, or a glTF 2.0 file (.gltf or .glb), relative to the "
        "graph file; on the command line, relative to the working directory.",
    ),
    "RG651": Message("error", "cannot open the scene {path}: {reason}", "{hint}"),
    "RG652": Message("error", "the scene '{scene}' has no camera '{name}'", "{hint}"),
    "RG653": Message(
        "error", "the camera's position and target are the same point {point}", "give `target` another point"
    ),
    "RG654": Message(
        "note",
        "the scene '{scene}' has no lights and the graph gives none: a default sun and sky light it",
        "add `lights:` to the scene to choose them",
    ),
    "RG655": Message(
        "note",
        "the graph's camera was placed for '{source}' and is not used with '{override}'",
        "to place it, change the graph instead: --set scene.source=... --set scene.camera.position=...",
    ),
    "RG656": Message(
        "note", "the scene '{source}' has nothing to draw", "check that the file holds meshes and a scene"
    ),
    "RG657": Message(
        "note",
        "the scene '{scene}' has a sun and no ambient light: a default sky lights what the sun does not reach",
        "give `lights: {{ambient: {{sky: [...], ground: [...]}}}}` to choose it; zeros for none",
    ),
}
