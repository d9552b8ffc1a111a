"""Demand `readme`: a page that says what, when and when not, its cost and accuracy, and whose idea it was."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

from rendergraph.conformance.demand import Shortfall
from rendergraph.conformance.subject import Subject

#: Sections by what they are called; a section starts with a heading (`## Cost`), a bold lead (`**Cost.**`) or, at the
#: start of a paragraph, its word and a colon (`Source: ...`).
SECTIONS: Final = {
    "when": ("Pick it", "When to pick it"),
    "when_not": ("Not", "Do not", "Pick another", "When not"),
    "cost": ("Cost", "Cost model"),
    "accuracy": ("Accuracy",),
    "source": ("Source", "Sources", "Citation"),
}
_LEAD: Final = re.compile(
    r"^#+[ \t]+(?P<heading>.+)$|\*\*(?P<bold>[A-Z][^*\n]*)\*\*|^(?P<plain>[A-Z]\w*):", re.MULTILINE
)
_FENCE: Final = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def check_readme(subject: Subject) -> Iterator[Shortfall]:
    """README.md beside the node, with its sections."""
    file = subject.node.folder / "README.md"
    if not file.is_file():
        yield Shortfall("no_readme", "there is no README.md beside the node")
        return
    text = file.read_text(encoding="utf-8")
    if not what(text):
        yield Shortfall("no_what", "below its title, README.md does not say in a sentence what the node does")
    found = sections(text)
    for name, leads in SECTIONS.items():
        if len(found.get(name, "").split()) < 2:
            wanted = " or ".join(f"`**{lead}**`" for lead in leads)
            yield Shortfall(f"no_{name}", f"README.md has no section {wanted} (or a heading of that name)")
    accuracy = found.get("accuracy", "")
    if accuracy and not re.search(r"\d|\bexact", accuracy, re.IGNORECASE):
        yield Shortfall("no_figure", "the section on accuracy gives no figure: write down what was measured")


def what(text: str) -> str:
    """The first paragraph below the title; empty where the page has none."""
    paragraphs = [part.strip() for part in re.split(r"\n\s*\n", text) if part.strip()]
    if not paragraphs or not paragraphs[0].startswith("# "):
        return ""
    own = paragraphs[0].partition("\n")[2].strip() or (paragraphs[1] if len(paragraphs) > 1 else "")
    return "" if re.match(r"[#|*`]", own) else own


def sections(text: str) -> dict[str, str]:
    """The text of each known section, up to the next lead of the same kind or any heading."""
    plain = _FENCE.sub("", text)
    leads = list(_LEAD.finditer(plain))
    found: dict[str, str] = {}
    for at, lead in enumerate(leads):
        word = (lead["heading"] or lead["bold"] or lead["plain"]).strip(" .:#").casefold()
        name = next((n for n, names in SECTIONS.items() if word in {known.casefold() for known in names}), None)
        if name is None or name in found:
            continue
        follows = (other for other in leads[at + 1 :] if other["heading"] or (not lead["heading"] and other["bold"]))
        end = next((other.start() for other in follows), len(plain))
        found[name] = plain[lead.end() : end].strip()
    return found
