"""RG3xx: resources and formats."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
    "RG301": Message(
        "error",
        "resource '{resource}': {first} and {second} exclude each other",
        "keep one of them",
        "A resource is one of: a texture (format, and a size by scale, like or fixed), a buffer (bytes), last frame's "
        "content (previous alone), or an image file (file, with format and mips if wanted).",
    ),
    "RG302": Message(
        "error",
        "resource '{resource}' has no format",
        "add format: (or bytes: for a buffer, or like: to take another's)",
    ),
    "RG303": Message("error", "unknown format '{format}'", "{hint}"),
    "RG304": Message(
        "error",
        "resources refer to each other in a circle: {cycle}",
        "give one of them a size of its own with fixed: or scale:",
    ),
    "RG305": Message("error", "resource '{resource}': {key_name} names '{other}', which does not exist", "{hint}"),
    "RG306": Message(
        "error",
        "resource '{resource}': {key_name} names '{other}', which is {problem}",
        "{hint}",
    ),
    "RG307": Message(
        "error",
        "resource '{resource}' would be {width} x {height} texels, more than {limit} a side",
        "lower scale:, fixed: or the frame's size",
    ),
    "RG308": Message(
        "error",
        "resource '{resource}' has {mips} mip levels, but {width} x {height} texels have only {most}",
        "write mips: 0 for the whole chain",
    ),
    "RG309": Message(
        "error",
        "resource '{resource}': a multisampled texture has one mip level",
        "remove mips: or samples:",
    ),
    "RG310": Message("error", "resource '{resource}': no file '{file}'", "check the name; it is relative to {folder}"),
    "RG311": Message(
        "error",
        "resource '{resource}': '{file}' lies outside the graph's folder",
        "copy the file next to the graph in {folder}",
    ),
    "RG312": Message(
        "error",
        "resource '{resource}': '{file}' is not a usable image: {reason}",
        "give a PNG, JPEG or Radiance .hdr file",
    ),
    "RG313": Message(
        "error",
        "resource '{resource}' would take {mib} MiB, more than {limit} MiB",
        "lower its size, layers or samples",
    ),
    "RG314": Message(
        "error",
        "resource '{resource}': an image file cannot become {format}",
        "use a colour format with real values, such as srgb8_a8 (colour), rgba8 (data) or rgba16f (.hdr)",
    ),
    "RG315": Message(
        "error",
        "resource '{resource}' and '{other}' both hold last frame's '{source}'",
        "read '{other}' in both places",
    ),
    "RG320": Message(
        "error",
        "port '{port}' of node '{node}' does not take format {format} of '{resource}'",
        "use one of {formats}",
    ),
    "RG321": Message(
        "error",
        "port '{port}' of node '{node}' takes a {wanted}, but '{resource}' is a {found}",
        "connect a {wanted}",
    ),
    "RG322": Message(
        "error",
        "port '{port}' of node '{node}' takes {wanted} samples a texel, but '{resource}' has {found}",
        "resolve it with a copy pass (blit: true), or change samples:",
    ),
    "RG323": Message(
        "error",
        "port '{port}' of node '{node}' takes {wanted} layers, but '{resource}' has {found}",
        "change layers: of the resource",
    ),
    "RG324": Message(
        "error",
        "'{resource}' at port '{port}' is {width} x {height}, "
        "but '{other}' at port '{like}' is {other_width} x {other_height}",
        "both must have one size: write `like: {other}` in the resource",
    ),
    "RG325": Message(
        "error",
        "pass '{name}' uses '{resource}' ({format}) as {usage}, {problem}",
        "{hint}",
    ),
    "RG326": Message(
        "error",
        "pass '{name}' draws into '{first}' ({first_is}) and '{second}' ({second_is}) at once",
        "give all attachments of a draw one size, one number of layers and one number of samples",
    ),
    "RG327": Message(
        "error",
        "pass '{name}' touches {part} {index} of '{resource}', which has {count}",
        "raise {part}s: of the resource",
    ),
    "RG330": Message("error", "output '{resource}': {problem}", "{hint}"),
}
