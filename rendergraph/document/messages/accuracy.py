"""RG728, RG729 and RG74x: references, and errors set against them."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
    "RG712": Message(
        "note",
        "pass '{name}': nothing of '{measure}' was judged, its reference knows the truth of no texel here",
        "judge the pass where it has something to judge: another size, scene or camera",
        "A reference leaves out what it cannot know. Where that is everything nothing was compared: the verdict is "
        "`cannot_judge`, which is no fault of the pass, and no pass either.",
    ),
    "RG728": Message(
        "error",
        "the truth of the shader '{shader}' is not known",
        "put {file} beside it, with a function judge(run) that computes what its outputs should hold",
        "What a user's own shader should have drawn, only its author can tell, in Python beside the shader: see "
        "docs/accuracy_user_shaders.md. Without that file the pass is rendered, and not judged.",
    ),
    "RG729": Message(
        "error",
        "{file} cannot tell the truth of a shader: {reason}",
        "mend it; judge(run) gives a Truth of the output's own shape for every output that it knows",
        "The file beside a user's shader is run where its pass is judged. It must lie in the graph's folder and define "
        "judge(run): see docs/accuracy_user_shaders.md.",
    ),
    "RG740": Message(
        "error",
        "'{resource}' does not grow with the frame: it cannot be supersampled",
        "give it a size relative to the frame, or judge the pass in a graph whose resources have one",
        "Some references (the one of antialiasing, for example) render a pass's input at several times the frame's "
        "size and average it back. That needs a resource whose width and height follow the frame's.",
    ),
    "RG741": Message(
        "error",
        "the reference of pass '{name}' cannot judge '{measure}': its truth is known to {error:.6g} only, at 3 "
        "standard errors, and must judge a tolerance of {tolerance:.6g}",
        "give the reference more samples, or the measure a tolerance that it can judge",
        "A truth that is found by sampling has an error of its own. Where three of its standard errors, in terms of "
        "the metric, are more than the tolerance, what is within it cannot be told, and nothing passes.",
    ),
    "RG742": Message(
        "error",
        "pass '{name}' (node {node}) is off: {measure} has {metric} {value}, its tolerance is {tolerance}{worst}",
        "{hint}",
        "The pass's output was compared with the truth that its node's reference.py computes; the tolerance is the "
        "error that the node states. `accurate` knobs trade time for error; where none is left to turn, the shader or "
        "the reference is wrong.",
    ),
    "RG743": Message(
        "error",
        "rays cannot be traced: embree is not installed",
        'run: pip install "rendergraph[reference]"',
        "Some references trace rays through the scene on the CPU. They need the package embreex, which the extra "
        "`reference` brings.",
    ),
    "RG744": Message(
        "error",
        "the reference of pass '{name}' (node {node}) fails: {reason}",
        "mend nodes/{node}/reference.py; `judge(run)` returns a Truth for every measure that the node declares",
        "A reference is the node's own code, reference.py beside its shaders. It must give a truth of the same size as "
        "what it judges for every measure named in `Reference.measures`.",
    ),
    "RG745": Message(
        "note",
        "truths are computed anew each time: {reason}",
        'run: pip install "rendergraph[reference]", or set RENDERGRAPH_CACHE to a folder',
        "References are kept on disk by the content of what they were computed from. Where the user's cache folder is, "
        "the package platformdirs tells, which the extra `reference` brings.",
    ),
    "RG746": Message(
        "error",
        "pass '{name}' cannot be judged: there is no such pass",
        "{hint}",
    ),
    "RG747": Message(
        "error",
        "pass '{name}' (node {node}) breaks an invariant: {what}",
        "mend the node; an invariant holds for every input and every parameter",
        "Whatever the truth is, an output must stay within the bounds that its node declares, and the checks of its "
        "reference's `invariants(run)` must hold.",
    ),
    "RG748": Message(
        "error",
        "FLIP cannot be computed: {reason}",
        "report it with the two images; the other metrics of the quantity need no further package",
    ),
    "RG749": Message(
        "error",
        "FLIP needs the package flip-evaluator, which is not installed",
        'pip install "rendergraph[flip]", or choose another metric',
    ),
}
