"""RG75x and RG76x: sweeps over parameters, and attribution of error."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
    "RG750": Message(
        "error",
        "nothing to sweep: {problem}",
        "{hint}",
        "`--over` names a knob as PASS.KNOB (`rg nodes NODE` lists a node's), or any path that `--set` takes.",
    ),
    "RG751": Message(
        "error",
        "'{text}' is no axis: {problem}",
        "{hint}",
        "An axis is PASS.KNOB alone (its choices, or its range in five steps), PASS.KNOB=low:high:count, with :log for "
        "even ratios, or PASS.KNOB=a|b|c. Commas separate axes.",
    ),
    "RG752": Message("error", "the axis {path} is named twice", "name each once, with all its values"),
    "RG753": Message(
        "error",
        "{count} settings ({sizes}) are too many: at most {most} are measured",
        "give fewer values, or `--samples N` for a Latin hypercube of N settings",
        "Every setting is compiled, warmed up and rendered many times. A Latin hypercube shows each value of each axis "
        "equally often in far fewer settings.",
    ),
    "RG754": Message(
        "error",
        "{folder} holds another sweep: {what}",
        "give --fresh to begin anew (what was measured there is deleted), or another folder with -o",
        "A sweep goes on where it was interrupted only where everything is as it was: the graph with its shaders and "
        "nodes, the axes and their settings, sizes, counts, the device and the program's version.",
    ),
    "RG755": Message(
        "error",
        "another sweep is running in {folder}",
        "wait until it ends, or give this one another folder with -o",
    ),
    "RG756": Message(
        "error",
        "{count} settings cannot be judged by {error}: {reason}",
        "judge by another measure (--error PASS.MEASURE), or by the image (--error image)",
        "A truth that is found by sampling has an error of its own. Where that is above the tolerance which it must "
        "judge, or where nothing of the truth is known, a setting gets no error and takes no part in the comparison.",
    ),
    "RG757": Message(
        "warning",
        "the error does not fall as {axis} becomes more accurate: {shape} ({values})",
        "{hint}",
        "A quality knob is worth its cost only where the error falls along it. Either the knob does nothing for this "
        "scene and this measure, or its node declares it the wrong way round, or something else now limits the error.",
    ),
    "RG758": Message(
        "error",
        "no such error: {problem}",
        "{hint}",
        "`--error PASS` or `--error PASS.MEASURE` names a measure of the node's reference (`rg nodes NODE`). "
        "`--error image` or `--error image:METRIC` compares the final image with that of the most accurate settings.",
    ),
    "RG759": Message(
        "error",
        "no output image depends on {what}",
        "sweep something that the graph's outputs show, or judge by the pass itself: --error PASS",
    ),
    "RG760": Message(
        "warning",
        "no setting satisfies the limit: {limit}",
        "{nearest}",
    ),
    "RG761": Message(
        "error",
        "a process of the sweep ended: {reason}",
        "run the same command again: it goes on where it stopped",
    ),
    "RG762": Message(
        "warning",
        "{count} settings were refused: {reason}",
        "leave them out of --over",
        "Each value is possible by itself, but not together with others. The rest was measured.",
    ),
    "RG763": Message(
        "error",
        "nothing to attribute: {reason}",
        "{hint}",
        "Error is shared out among passes that approximate something: those whose node has an ideal reference of an "
        "output, or knobs that trade accuracy for time.",
    ),
    "RG764": Message(
        "error",
        "there is nothing to plot: no setting has both a time and an error",
        "judge by another measure (--error), or leave --png out",
    ),
}
