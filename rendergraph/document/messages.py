"""Every diagnostic the tool can give: one table of stable codes, and the error that carries them.

Codes: RG1xx syntax, 2xx graph, 3xx resource and format, 4xx barrier, 5xx device, 6xx scene, 7xx accuracy and budget.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Final

from rendergraph.plan.graph import Position


@dataclass(frozen=True, slots=True)
class Message:
    """One row of the table: ``text`` and ``help`` are ``str.format`` templates; ``rg explain`` adds ``explain``."""

    severity: str  # "error" | "warning" | "note"
    text: str
    help: str
    explain: str = ""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A message with its values and place. ``data`` holds the template's values, for tests and JSON."""

    code: str
    severity: str
    text: str
    help: str
    position: Position | None = None
    data: dict[str, Any] = field(default_factory=dict)


def diagnose(code: str, position: Position | None = None, **data: Any) -> Diagnostic:
    """Fill in a row of the table. ``KeyError`` for an unknown code or a value the template needs and did not get."""
    message = MESSAGES[code]
    return Diagnostic(code, message.severity, message.text.format(**data), message.help.format(**data), position, data)


class RenderGraphError(Exception):
    """A user's mistake, or the environment's: one or more diagnostics. ``exit_code`` is the command line's."""

    def __init__(self, diagnostics: Iterable[Diagnostic], exit_code: int = 1) -> None:
        self.diagnostics = tuple(diagnostics)
        self.exit_code = exit_code
        super().__init__("; ".join(f"{d.code} {d.text}" for d in self.diagnostics))


_LOCK_HELP: Final = "if it is meant, `rg plan GRAPH --lock FILE` writes the lock anew"

MESSAGES: Final[dict[str, Message]] = {
    # ---- RG1xx: the file and its syntax
    "RG100": Message(
        "error",
        "no graph file '{path}'",
        "{hint}",
        "The argument is neither a file nor the name of a shipped graph. A name without folder and extension, such as "
        "`deferred_shading`, is looked up among the shipped graphs when no file of that name exists.",
    ),
    "RG101": Message(
        "error",
        "cannot read '{path}': {reason}",
        "{hint}",
        "The path exists but gives no text: it is a directory, reading it is not permitted, or the disk failed.",
    ),
    "RG102": Message(
        "error",
        "not UTF-8: byte {byte} at offset {offset}",
        "{hint}",
        "Graph files are UTF-8, with or without a byte-order mark. Line and column count from the start of the file as "
        "far as it could be decoded.",
    ),
    "RG103": Message(
        "error",
        "too large: {what} above the limit of {limit}",
        "split the graph, or generate less of it",
        "A graph file may have 8 MiB and 500,000 values, aliases counted as often as they are used. The limits keep a "
        "mistaken or hostile file from exhausting memory; a graph of 10,000 passes stays far below them.",
    ),
    "RG104": Message(
        "error",
        "not valid YAML: {problem}",
        "{hint}",
        "The file cannot be parsed from here on, so nothing after this place has been checked. Frequent causes: a tab "
        "in the indentation, a missing space after a colon, an unclosed bracket or quote, inconsistent indentation.",
    ),
    "RG105": Message(
        "error",
        "key '{key}' is given twice, first at {first}",
        "remove or rename one of the two",
        "YAML forbids equal keys in one mapping. Many readers silently keep the last; here the second is an error, so "
        "that a pass or resource is never lost to a copy and paste.",
    ),
    "RG106": Message(
        "error",
        "a key must be text, found {found}",
        "{hint}",
        "Keys of a graph file name passes, resources, ports and parameters, and are text. Unquoted `1`, `true`, `null` "
        "are not text in YAML; `on`, `off`, `yes` and `no` are (YAML 1.2).",
    ),
    "RG107": Message(
        "error",
        "tag '{tag}' is not allowed",
        "remove the tag; quote a value to make it text",
        "Tags (`!name`, `!!python/object`) ask the reader to build special objects. Graph files hold only mappings, "
        "lists, text, numbers, booleans and null; nothing in them is ever executed.",
    ),
    "RG108": Message(
        "error",
        "nested deeper than {limit} levels",
        "flatten the document",
        "No part of the language needs more than a handful of levels.",
    ),
    "RG109": Message(
        "error",
        "{problem}",
        "{hint}",
        "An alias (`*name`) repeats the value marked by its anchor (`&name`) earlier in the file; it may not stand "
        "inside that value. A merge key (`<<`) takes a mapping or a list of mappings.",
    ),
    "RG110": Message(
        "error",
        "{problem}",
        "a graph file is a mapping that starts with `rendergraph: 1`; `rg new graph` writes one",
        "The document as a whole must be a mapping with at least `rendergraph`, `passes` and `outputs`.",
    ),
    "RG111": Message(
        "error",
        "a second document starts here",
        "keep one graph a file: remove the `---`, or move what follows to a file of its own",
        "A line `---` separates YAML documents. A graph file holds exactly one.",
    ),
    "RG112": Message(
        "error",
        "ambiguous or impossible number {text}: {problem}",
        "{hint}",
        "YAML 1.1 reads `010` as octal 8, YAML 1.2 as decimal 10. Rather than pick one silently, the reader asks: "
        "write `10`, `0o10` or `'010'`. Numbers must also fit 64 bits.",
    ),
    "RG113": Message(
        "warning",
        "`{text}` is text here, not a boolean",
        "write {boolean} for the boolean, or quote it ('{text}') for the text",
        "YAML 1.1 reads the bare words yes, no, on and off as booleans; YAML 1.2, which this tool follows, as text. "
        "Other tools may disagree about the file until the word is quoted.",
    ),
    "RG114": Message(
        "note",
        "more mistakes follow; the first {limit} are shown",
        "mend these and check again",
        "A document wrong in hundreds of places is most often wrong in one way, many times over.",
    ),
    "RG120": Message(
        "error",
        "{where} lacks the key '{key}'",
        "{hint}",
        "A required key is absent. `docs/yaml.md` lists every key with its type, range and default.",
    ),
    "RG121": Message(
        "error",
        "unknown key '{key}' in {where}",
        "{hint}",
        "Keys that nothing reads are errors, since most are misspelled. Parameters of a node go under its `set:`.",
    ),
    "RG122": Message(
        "error",
        "{where} must be {expected}, found {found}",
        "{hint}",
        "Types are strict: a quoted number is text, `1` is not `true`, and `yes` is text (YAML 1.2).",
    ),
    "RG123": Message(
        "error",
        "{where} must be {expected}, found {found}",
        "{hint}",
        "The value has the right type but lies outside its range.",
    ),
    "RG124": Message(
        "error",
        "{where} must be {expected}, found {found}",
        "{hint}",
        "The key takes one of a fixed set of values.",
    ),
    "RG125": Message(
        "error",
        "{found} is not a name",
        "start with a letter or underscore and go on with letters, digits and underscores, at most 64",
        "Names of passes and resources appear in shaders, reports and on the command line, so they are plain "
        "identifiers. A node's internal resource is written `pass.name`.",
    ),
    "RG126": Message(
        "error",
        "{where} must be {expected}, found {found}",
        "{hint}",
        "The text or list is shorter or longer than allowed.",
    ),
    "RG127": Message(
        "error",
        "{where}: {problem}",
        "{hint}",
        "Each value is fine by itself, but together they make no sense.",
    ),
    "RG130": Message(
        "error",
        "override '{argument}' is not of the form path=value",
        "write for example --set frame.count=8 or --set passes.blur.set.radius=2",
        "An override names a key of the graph file by its dotted path; what follows the first `=` is read as YAML.",
    ),
    "RG131": Message(
        "error",
        "override path '{path}' does not exist: {problem}",
        "{hint}",
        "An override changes or adds a value below something the file has. It can set keys the file leaves at their "
        "defaults (`frame.seed=3`) but cannot reach into a pass, resource or output that is not there.",
    ),
    # ---- RG2xx: the graph
    "RG200": Message(
        "error",
        "pass '{name}' uses an unknown node '{node}'",
        "{hint}",
        "Nodes are folders below `nodes/`, or come with installed packages. `rg nodes` lists them.",
    ),
    "RG201": Message(
        "error",
        "node '{node}' has no {direction} port '{port}'",
        "{hint}",
        "`read:` maps the node's input ports to resources and `write:` its output ports. `rg nodes NAME` lists them.",
    ),
    "RG202": Message(
        "error",
        "pass '{name}' does not connect the required input '{port}' of node '{node}'",
        "add `{port}: RESOURCE` under `read:` ({meaning})",
        "Every input port that is not optional must be given a resource.",
    ),
    "RG203": Message(
        "error",
        "pass '{name}' does not connect the required output '{port}' of node '{node}'",
        "add `{port}: RESOURCE` under `write:` ({meaning})",
        "Every output port that is not optional must be given a resource. It is declared under `resources:`, "
        "or named in `outputs:`.",
    ),
    "RG204": Message(
        "error",
        "node '{node}' has no parameter '{key}'",
        "{hint}",
        "`rg nodes NAME` lists a node's parameters with units, ranges and defaults.",
    ),
    "RG205": Message(
        "error",
        "{where} {problem}",
        "{hint}",
        "The parameter's type, range or choice, as its node declares it, is not met. `rg nodes NAME` shows them.",
    ),
    "RG206": Message(
        "error",
        "pass '{name}' does not set the required parameter '{key}' of node '{node}'",
        "add `{key}: VALUE` under `set:`{meaning}",
        "The parameter has no default.",
    ),
    "RG207": Message(
        "error",
        "node '{node}' is broken: {reason}",
        "this is a defect of the node's package, not of the graph; report it there or remove the pass",
        "The node's folder or entry point exists, but importing it failed, it does not define exactly one node, or "
        "its check of the parameters failed by itself.",
    ),
    "RG212": Message(
        "error",
        "no resource '{resource}'",
        "{hint}; declare it under resources:",
        "A pass may read and write what `resources:` declares, write an undeclared name of `outputs:`, and read "
        "another pass's internal target as `pass.name`.",
    ),
    "RG213": Message(
        "error",
        "no pass writes the output '{resource}'",
        "connect it under write: of a pass; {hint}",
        "An output is a file written from a resource after the frame: some pass must have produced its content.",
    ),
    "RG214": Message(
        "warning",
        "resource '{resource}' is not used",
        "connect it to a pass, or remove it",
        "Nothing reads, writes or refers to it, so nothing is allocated for it.",
    ),
    "RG215": Message(
        "error",
        "pass '{name}' writes '{resource}', which is {kind}",
        "write another resource; {instead}",
        "A file's image never changes, and last frame's content (`previous:`) is what the frame before left behind.",
    ),
    "RG216": Message(
        "error",
        "pass '{name}' reads '{resource}' through '{read}' and replaces it through '{write}'",
        "write to a second resource of the same size, or read last frame's with `previous: {resource}`",
        "A pass that replaces a texture cannot sample it in the same draw: OpenGL leaves the result undefined. Ports "
        "marked `modify` add to what is there and may be connected to what is read.",
    ),
    "RG217": Message(
        "error",
        "pass '{name}' writes '{resource}' through both '{first}' and '{second}'",
        "give each output port a resource of its own",
    ),
    "RG218": Message("error", "pass '{name}' runs after '{other}', {problem}", "{hint}"),
    "RG219": Message("error", "barrier: no {what} '{name}'", "{hint}"),
    "RG220": Message(
        "error",
        "'{resource}' is no internal target of pass '{owner}'",
        "{hint}",
        "`pass.name` reads a target that a node made for itself, as it is after expansion for this scene. Such targets "
        "can be read and output, never written from outside.",
    ),
    "RG221": Message(
        "error",
        "passes read each other's internal targets in a circle: {cycle}",
        "pass the content on through a declared resource instead",
    ),
    "RG222": Message(
        "error",
        "pass '{name}': {field} '{file}' {problem}",
        "name a file inside the graph's folder {folder}",
        "Files are looked up relative to the graph file and must stay inside its folder, so that a graph can be moved "
        "as a whole and an untrusted one cannot read elsewhere.",
    ),
    "RG223": Message(
        "error",
        "'{resource}' holds last frame's '{source}', which no pass writes",
        "write '{source}' in some pass",
    ),
    "RG224": Message(
        "error",
        "pass '{name}' (node '{node}') draws the scene, but the graph has none",
        "add a scene: section, or pass --scene",
    ),
    "RG225": Message(
        "error",
        "pass '{name}': {problem}",
        "{hint}",
        "The parameters of this pass do not fit what is connected to it.",
    ),
    "RG226": Message("error", "the frame's {what} is {value}", "choose one from 1 to {limit}"),
    "RG227": Message("error", "there is no code {name}", "give a code as a message shows it, such as RG203"),
    "RG228": Message("error", "the graph has no pass, sub-pass or resource '{name}'", "{hint}"),
    "RG229": Message(
        "error",
        "internal error in node '{node}' (pass '{name}'): {reason}",
        "this is a defect of the node, not of the graph; please report it with the graph file",
        "The node's build() failed, or declared sub-passes that contradict its ports.",
    ),
    "RG230": Message(
        "error",
        "'{first}' and '{second}' both write '{resource}', and nothing says which comes first",
        "add `after: [{first}]` to '{second}' (or the other way round); '{first}' is at {place}",
        "Passes may be listed in any order, so the file's order decides nothing. The pass that replaces all of the "
        "content comes first by itself; of two that add to it, or two that replace it, one needs `after:` or must read "
        "something that depends on the other.",
    ),
    "RG231": Message(
        "error",
        "'{name}' reads '{resource}', which no pass writes",
        "write '{resource}' in some pass, or read another resource",
        "A transient resource holds nothing at the start of a frame. Last frame's content is a resource of its own, "
        "declared with `previous:`.",
    ),
    "RG232": Message(
        "error",
        "'{name}' adds to '{resource}' before anything gave it content",
        "write all of '{resource}' first, for example with a `clear` pass",
        "Blending, depth testing against loaded depth, atomics and partial stores keep what was there. Some pass must "
        "first define it; '{name}' itself cannot.",
    ),
    "RG233": Message(
        "error",
        "passes wait for each other in a circle: {path}",
        "break it: read last frame's content through `previous:`, or drop an `after:`; {steps}; {places}",
        "Each arrow reads 'must run before'. A pass is one unit here, even when its sub-passes could be interleaved.",
    ),
    "RG234": Message(
        "error",
        "the output '{resource}' is written by no pass",
        "write '{resource}' in some pass, or remove it from outputs:",
    ),
    "RG235": Message(
        "error",
        "'{resource}' is the history of '{source}', which no pass writes",
        "write '{source}' in some pass, or remove '{resource}'",
    ),
    "RG236": Message(
        "error",
        "'{name}' writes '{resource}', which is {kind} and can only be read",
        "write another resource; a history changes by writing the resource it is the history of",
    ),
    "RG237": Message(
        "error",
        "'{name}' must run before '{resource}' has content",
        "remove the `after:` that puts '{name}' before the first writer of '{resource}'",
    ),
    "RG239": Message(
        "note",
        "'{name}' does not run: nothing it writes reaches an output",
        "read its result, name it under outputs:, or set `keep: true`; `rg explain` tells who would have read it",
    ),
    # ---- RG3xx: resources and formats
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
    # ---- RG4xx: barriers
    "RG401": Message(
        "error",
        "missing barrier: '{before}' uses '{resource}' after '{after}', with no {kind} barrier between them",
        "add `- {{resource: {resource}, after: {after}, before: {before}, kind: {kind}}}` to barriers:, or remove the "
        "section to have all barriers derived",
        "One of the two accesses is a shader store or atomic, which OpenGL does not order by itself (4.5 "
        "core, 7.13.2). "
        "The kind names how the resource is used next.",
    ),
    "RG402": Message(
        "warning",
        "redundant barrier: nothing calls for one on '{resource}' between '{after}' and '{before}'",
        "remove it",
        "OpenGL orders drawing, sampling, copies and clears by itself; only shader stores and atomics need barriers.",
    ),
    "RG403": Message(
        "warning",
        "barrier of the wrong kind: '{before}' needs {needed} on '{resource}' after '{after}', not {kind}",
        "state {needed} in place of {kind}",
        "A bit of glMemoryBarrier names how memory is used after it, not how it was written.",
    ),
    "RG404": Message(
        "note",
        "barrier on '{resource}' between '{after}' and '{before}': '{gone}' does not run",
        "nothing to do; it applies again when '{gone}' runs",
    ),
    # ---- RG5xx: the device, programs, files written
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
    # ---- RG6xx: the scene
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
    # ---- RG7xx: accuracy and budget
    # -- budgets
    "RG701": Message(
        "error",
        "{who}the frame takes {found:.3f} ms, its budget is {limit:g} ms: pass '{name}' takes the most, {share:.0f} %",
        "make '{name}' cheaper (`rg nodes {node}` lists its knobs), or raise frame_ms",
        "The median of the timed whole frames is compared with `budget.frame_ms`. The pass named has the largest "
        "median of those timed one by one; its share is of their sum. The clock is named in timing.json: on a software "
        "renderer or a shared machine leave room to spare.",
    ),
    "RG702": Message(
        "error",
        "{who}pass '{name}' takes {found:.3f} ms, its budget is {limit:g} ms{worst}",
        "make it cheaper (`rg nodes {node}` lists its knobs), or raise its budget",
        "The median over the timed frames of the sum of the pass's sub-passes is compared with `budget.passes`.",
    ),
    "RG703": Message(
        "error",
        "{who}transient memory is {found:.6g} MiB, the budget is {limit:g} MiB: at the peak, in {at}, live {peak}",
        "{hint}",
        "What counts is the memory that the plan really uses for transient targets and buffers (`used` in "
        "resources.json), without the driver's padding. It is exact, and known without a GPU.",
    ),
    "RG704": Message(
        "error",
        "{who}the frame makes {found} draws, its budget is {limit}: pass '{name}' makes the most, {most}",
        "batch or cull in '{name}', or raise draws",
        "Each draw of a multi-draw counts, as in the counter `draws` of timing.json. It is exact.",
    ),
    "RG705": Message(
        "warning",
        "transient memory is {found:.6g} MiB in a scene that uses every feature, the budget is {limit:g} MiB: at the "
        "peak, in {at}, live {peak}",
        "`rg plan` loads the scene and tells exactly",
        "`rg validate` does not load scenes and plans for one with every feature, so what it finds is about the most "
        "the graph can take. `rg plan` and `rg render` specialise on the real scene and fail with RG703 when that is "
        "too much.",
    ),
    "RG706": Message(
        "error",
        "the budget names a pass '{name}', which does not exist",
        "{hint}",
        "`budget.passes` maps names of passes, not of their sub-passes, to milliseconds.",
    ),
    "RG707": Message(
        "note",
        "pass '{name}' has a budget but does not run",
        "remove its budget, or see `rg explain` for why it is left out",
    ),
    "RG708": Message(
        "note",
        "the budget of {what} was not checked: {reason}",
        "{hint}",
        "A limit that nothing was compared with is no limit: it is said rather than passed over.",
    ),
    "RG709": Message(
        "note",
        "the budget of flip is not checked yet",
        "compare the image with its reference by hand for now",
        "FLIP needs a reference image, and no command compares with one yet. The limit is read and kept.",
    ),
    # -- plan locks
    "RG720": Message("error", "cannot compare the plan with '{path}': {reason}", "{hint}"),
    "RG721": Message(
        "error",
        "{lock}: {what} {change} by {by}: {before} -> {after} bytes",
        _LOCK_HELP,
        "`used` is what the plan's transient targets and buffers take, `load` the most that is live at once, "
        "`unshared` what they would take without sharing, `heap` the part of `used` that holds buffers.",
    ),
    "RG722": Message(
        "error",
        "{lock}: the barrier before '{name}' {change}",
        _LOCK_HELP,
        "A barrier that was added or widened costs time; one that is gone was no longer needed, which is right only if "
        "the accesses it stood between are really gone.",
    ),
    "RG723": Message("error", "{lock}: order: '{name}' {change}", _LOCK_HELP),
    "RG724": Message("error", "{lock}: '{name}' {change}", _LOCK_HELP),
    "RG725": Message("error", "{lock}: the slot of {tenants} {change}", _LOCK_HELP),
    "RG726": Message("error", "{lock}: the resource '{name}' {change}", _LOCK_HELP),
    "RG727": Message(
        "error",
        "{lock}: it is for a frame of {before}, this plan for one of {after}",
        "give the --size that the lock was written with, or write it anew with `rg plan GRAPH --lock FILE`",
    ),
    # -- records that are compared
    "RG730": Message("error", "no record at '{path}': {reason}", "{hint}"),
    "RG731": Message(
        "error",
        "'{path}' is not JSON: {reason}",
        "write the record again; a run that was stopped leaves no half record, a failed download or copy may",
    ),
    "RG732": Message(
        "error",
        "'{path}' is not a record that can be compared: {reason}",
        "give a folder written by `rg render`, its timing.json or resources.json, or a file written by `rg bench`",
    ),
    "RG733": Message(
        "error",
        "'{path}' has schema {schema}, and this version reads {known}",
        "compare with the version of rendergraph that wrote it, or write both records with one version",
    ),
    "RG734": Message(
        "error",
        "'{path}': {where}: {reason}",
        "the record was changed after it was written, or another tool wrote it: write it again",
    ),
    "RG735": Message(
        "error",
        "'{path}': {where} is {value}, which is no time",
        "write the record again; if it comes back, the clock is at fault: see `rg doctor`",
        "Samples are finite and not negative. One that is not makes every figure of its record doubtful, so nothing is "
        "compared.",
    ),
    "RG736": Message(
        "error",
        "the records differ in {fields}: {details}",
        "measure both under the same conditions; resources.json files can be compared whatever ran them; --force "
        "compares all the same",
        "Times are comparable only with the same clock, renderer, driver, processor, number of threads and frame size: "
        "otherwise the difference says nothing of the graphs. Bytes depend on the frame size alone.",
    ),
    "RG737": Message("error", "cannot compare '{name}': {reason}", "{hint}"),
    "RG738": Message(
        "warning",
        "times of {name} cannot be judged: {samples} {unit}, at least {least} are needed",
        "measure with `rg bench`, or render with more --samples",
        "Too few samples can neither show a change nor show that there is none, so the verdict is "
        "inconclusive. Samples "
        "of one run resemble each other; where they do, more of them are needed.",
    ),
    "RG739": Message(
        "warning",
        "the records differ in {fields}, and are compared because of --force: {details}",
        "do not take the difference in times for one of the graphs",
    ),
}
