"""RG7xx: budgets, plan locks, records that are compared."""

from typing import Final

from rendergraph.document.messages.message import Message

_LOCK_HELP: Final = "if it is meant, `rg plan GRAPH --lock FILE` writes the lock anew"

ROWS: Final[dict[str, Message]] = {
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
        "{who}the frame makes {found} draws (in {calls} draw calls), its budget is {limit}: pass '{name}' makes the "
        "most, {most}",
        "instance, merge or cull what '{name}' draws, or raise draws",
        "Each draw of a multi-draw counts, as in the counter `draws` of timing.json; its `draw_calls` counts the calls "
        "that make them. Both are exact.",
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
        "the budget of {what} was not checked: it takes references",
        "render with --reference",
        "Errors are known only where passes are held against their references, which can take long: `rg render` does "
        "so with --reference.",
    ),
    "RG710": Message(
        "error",
        "pass '{name}': {measure} has {metric} {found}, its budget is {limit:g}",
        "{hint}",
        "Each measure of the pass's reference is compared, by the metric that the node states, with `budget.error`.",
    ),
    "RG711": Message(
        "error",
        "output '{name}' of pass '{writer}' has a mean FLIP error of {found:.6g}, the budget is {limit:g}",
        "{hint}",
        "The images that passes with a reference write into the graph's outputs are compared with their truths by "
        "FLIP, the difference that is seen when both alternate on a screen.",
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
        "give a folder written by `rg render`, a record in it, or a file written by `rg bench`",
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
