"""RG1xx: the file and its syntax."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
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
}
