"""RG5xx: the device, programs, files read and written."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
    "RG500": Message(
        "error",
        "OpenGL refused a call{where}{what}: {detail}",
        "this is a mistake in the pass's sizes, formats or bindings, or in the tool; run `rg plan` to see "
        "what it binds",
        "Raised when the driver reports an error while a pass runs. It names the pass, the resource where "
        "one is known, "
        "and the line of the graph that asked for the pass.",
    ),
    "RG501": Message(
        "error",
        "{library} cannot be loaded, so no OpenGL context can be made: {detail}",
        "install it with: {apt}",
        "Rendering needs the EGL library and an OpenGL 4.5 driver; `rg validate` and `rg plan` need neither.",
    ),
    "RG502": Message(
        "error",
        "EGL device {index} gives no OpenGL driver: {detail}",
        "install Mesa's with: {apt}; in a container also give access to /dev/dri, or to the NVIDIA graphics libraries "
        "(NVIDIA_DRIVER_CAPABILITIES=graphics)",
        "The EGL library is there, but no driver stands behind it.",
    ),
    "RG503": Message("error", "there is no EGL device {index}: {detail}", "`rg doctor` lists the devices there are"),
    "RG504": Message(
        "error",
        "EGL device {index} has no OpenGL {required}: {found}",
        "pick another device, or install Mesa's software driver with: {apt}",
    ),
    "RG505": Message(
        "error", "{renderer} lacks {missing}", "pick another device (`rg doctor` lists them) or a newer driver"
    ),
    "RG506": Message(
        "error",
        "device {index} was asked for, but device {open} is already open in this process",
        "close it first, or use another process: one OpenGL context per process",
    ),
    "RG507": Message(
        "warning",
        "the driver warns of undefined behaviour{where}{what}: {detail}",
        "what this pass draws may differ on another driver: check its sizes, formats and bindings with `rg plan`",
        "Said once for every pass and resource that it concerns, and kept in the timing record. The driver goes on, so "
        "the image may look right on this machine.",
    ),
    "RG510": Message("error", "shader file {file} cannot be read: {detail}", "{hint}"),
    "RG511": Message(
        "error",
        "#include {name} is not found{chain}",
        'looked in {searched}; <name> is the shared library\'s, "name" is relative to the including file',
    ),
    "RG512": Message("error", "#include {name} includes itself: {chain}", "break the cycle"),
    "RG513": Message(
        "error",
        "#include {name} leaves the folders shaders may come from{chain}",
        "keep it beside the shader, or in {roots}",
    ),
    "RG514": Message(
        "error",
        "this line is not a directive the preprocessor knows: {text}",
        'write #include <file> or #include "file"',
    ),
    "RG515": Message(
        "error", "{stage} shader does not compile: {detail}", "correct that line; {needed} needs this shader"
    ),
    "RG516": Message(
        "error", "the program {program} does not link: {detail}", "make the stages agree on what they pass on"
    ),
    "RG517": Message(
        "error",
        "uniform {name} is {expected} in the shader, but {got} is given",
        "give {count} value(s) of its type",
    ),
    "RG518": Message(
        "error",
        "the program {program} has no uniform {name}",
        "{hint}",
        "A uniform the shader declares but does not use is removed by the compiler.",
    ),
    "RG520": Message("error", "texture {label} cannot be made: {reason}", "change its size, layers, mips or samples"),
    "RG521": Message(
        "error", "out of memory for {label} ({bytes} bytes)", "use smaller targets, or a device with more memory"
    ),
    "RG522": Message(
        "error",
        "{label}: {view} cannot be a view of {storage}: {reason}",
        "a view keeps the view class, size and samples of its storage",
    ),
    "RG523": Message(
        "error", "the targets of {label} do not fit together: {reason}", "give them one size and sample count"
    ),
    "RG524": Message("error", "{label}: {reason}", "hand over an array of the shape and dtype named"),
    "RG525": Message("error", "buffer {label}: {reason}", "keep offset and size within its {bytes} bytes"),
    "RG526": Message(
        "error", "out of memory: {detail}", "use a smaller --size, fewer frames a run, or smaller targets"
    ),
    # -- files written and read by a run
    "RG560": Message(
        "error",
        "cannot write {path}: {reason}",
        "choose another folder with -o, or free space and permissions there; nothing was left half-written",
    ),
    "RG561": Message("error", "{path}: no image is written as '{suffix}'", "use one of {known}"),
    "RG562": Message(
        "error", "{path}: EXR files need the OpenEXR library", "pip install 'rendergraph[exr]', or write .npy instead"
    ),
    "RG563": Message("error", "cannot read the image {path}: {reason}", "give a PNG, JPEG or Radiance .hdr file"),
    "RG564": Message(
        "error",
        "no resource '{name}' to capture",
        "capture one of {known}",
        "Only resources that a pass of the finished plan touches can be captured. A culled pass writes "
        "nothing: run with "
        "--no-cull to keep it.",
    ),
    "RG565": Message(
        "error",
        "pass '{subpass}' wrote {value} into '{resource}' at texel ({x}, {y}){where}",
        "{count} texels of {total} are not finite; look at that pass's inputs there with --capture",
    ),
    "RG566": Message(
        "error",
        "pass '{subpass}': the shader uses {kind} '{name}', which nothing binds",
        "connect a resource to it under read: or write:, or remove it from {file}",
    ),
    "RG567": Message(
        "error", "pass '{subpass}': the scene is needed but the graph has none", "add a scene: section, or pass --scene"
    ),
    "RG568": Message(
        "error",
        "the capture of '{name}' and the output '{output}' would both write {file}",
        "give the output another file, as --set outputs.{output}.file=final.png",
    ),
    "RG569": Message(
        "error",
        "pass '{subpass}' draws into '{resource}', but its shader has no output at location {location}",
        "declare it: layout(location = {location}) out vec4 o_color; colours under write: are numbered in order",
        "OpenGL leaves a colour target without an output undefined. An output that is declared but never assigned is "
        "removed by the compiler.",
    ),
    "RG570": Message("error", "there is no node '{name}'", "{hint}"),
    "RG571": Message("error", "{path} exists already", "choose another name, or remove it first"),
    "RG572": Message(
        "error", "'{name}' cannot be a node's name", "use lower-case letters, digits and underscores, as in my_blur"
    ),
    "RG573": Message(
        "error", "cannot write to standard output: {reason}", "redirect it elsewhere, or free space where it goes"
    ),
    "RG575": Message("error", "no frame was timed, so there is nothing to trace", "ask for --samples 1 or more"),
    "RG580": Message(
        "error",
        "worker process {process} did not finish: {reason}",
        "run `rg render` on the graph to see what goes wrong; with less memory, measure at a smaller --size",
        "`rg bench` measures in fresh processes. One of them ended without reporting a mistake: killed for "
        "its memory, or "
        "crashed in the driver. What was measured before is kept.",
    ),
    "RG581": Message(
        "error",
        "{problem}",
        "{hint}",
        "`rg bench` compares at most two sides: two graphs, or one graph under two sets of overrides (--a and --b).",
    ),
    "RG582": Message(
        "warning",
        "side {side} was not steady after {frames} warm-up frames",
        "raise --warm-up, or measure when the machine does less else",
        "Frames are run until their running median stays within a band, see `warm_up` in the record. Where "
        "it does not, "
        "times drift or jump, and comparing them may say more about the machine than about the graph.",
    ),
    "RG574": Message(
        "error", "cannot make {path}: there is no folder {folder}", "make the folder first, or check its name"
    ),
}
