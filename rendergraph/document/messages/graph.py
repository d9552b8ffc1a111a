"""RG2xx: the graph."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
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
}
