"""Resources of the file to descriptions: sizes, formats, histories and image files.

What one resource's keys say among themselves is checked when the file is loaded (RG301, RG302, RG303, RG309).

``like`` and ``previous`` refer to other resources, so they are resolved in chains; every mistake is reported once and
whatever depends on a wrong resource stays silent.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rendergraph.document.field_types import MAX_SIZE
from rendergraph.document.formats import REAL
from rendergraph.document.models import ResourceModel
from rendergraph.document.suggest import did_you_mean
from rendergraph.plan.findings import Findings
from rendergraph.plan.graph import BufferDesc, Frame, Kind, Resource, Target, TextureDesc
from rendergraph.plan.graph_files import MISSING, file_problem, locate
from rendergraph.plan.image_header import image_size

Desc = TextureDesc | BufferDesc

#: More than this in one resource is a slip of the pen rather than a wish.
MAX_BYTES = 4 << 30


@dataclass
class ResourceResolver:
    """Resolves the declared resources of one document, and outputs that are not declared by a format it is told."""

    findings: Findings
    frame: Frame
    undeclared: Mapping[str, Desc]  # outputs that resources: does not name
    resolved: dict[str, Resource | None] = field(default_factory=dict)  # None: wrong, and reported

    def run(self) -> dict[str, Resource | None]:
        """All resources by name; ``None`` where a mistake was found."""
        declared = self.findings.document.model.resources
        for name, desc in self.undeclared.items():
            at = self.findings.document.position("outputs", name, key=True)
            self.resolved[name] = self._within_limits(Resource(name, desc, position=at), ("outputs", name))
        for name in declared:
            self._resolve(name)
        self._check_histories()
        return self.resolved

    def _resolve(self, name: str) -> None:
        """Follow references to one that stands alone, then resolve the way back (no recursion: chains may be long)."""
        declared = self.findings.document.model.resources
        chain: list[str] = []
        seen: set[str] = set()
        at: str | None = name
        while at is not None and at in declared and at not in self.resolved:
            if at in seen:
                circle = chain[chain.index(at) :]
                key = "like" if declared[at].like == circle[1 % len(circle)] else "previous"
                self.findings.add("RG304", "resources", at, key, cycle=" -> ".join([*circle, at]))
                self.resolved.update(dict.fromkeys(circle))
                break
            seen.add(at)
            chain.append(at)
            at = declared[at].previous or declared[at].like
        for link in reversed(chain):
            if link not in self.resolved:
                self.resolved[link] = self._make(link, declared[link])

    # ---- one resource

    def _make(self, name: str, model: ResourceModel) -> Resource | None:
        at = self.findings.document.position("resources", name, key=True)
        if model.previous is not None:
            source = self._referred(name, "previous", model.previous)
            return Resource(name, source.desc, Kind.HISTORY, source.name, position=at) if source else None
        if model.bytes is not None:
            return Resource(name, BufferDesc(model.bytes), position=at)
        if model.file is not None:
            return self._image_file(name, model, model.file)
        desc = self._texture(name, model)
        return self._within_limits(Resource(name, desc, position=at), ("resources", name)) if desc else None

    def _referred(self, name: str, key: str, other: str) -> Resource | None:
        """The resource that ``like`` or ``previous`` names, if it may be named there."""
        if other not in self.resolved:
            hint = did_you_mean(other, {*self.findings.document.model.resources, *self.undeclared} - {name})
            self.findings.add("RG305", "resources", name, key, resource=name, key_name=key, other=other, hint=hint)
            return None
        found = self.resolved[other]
        if found is None:
            return None
        problem, hint = "", ""
        if key == "like" and isinstance(found.desc, BufferDesc):
            problem, hint = "a buffer and has no size in texels", "name a texture, or give bytes:"
        elif key == "previous" and found.kind is Kind.HISTORY:
            problem, hint = "itself last frame's content", "only one frame is kept; copy it into a resource of your own"
        elif key == "previous" and found.kind is Kind.IMPORTED:
            problem, hint = "a file and never changes", f"read {other} itself"
        if problem:
            self.findings.add(
                "RG306", "resources", name, key, resource=name, key_name=key, other=other, problem=problem, hint=hint
            )
            return None
        return found

    # ---- textures

    def _texture(self, name: str, model: ResourceModel) -> TextureDesc | None:
        width, height, format = self.frame.width, self.frame.height, model.format
        if model.fixed is not None:
            width, height = model.fixed
        if model.like is not None:
            base = self._referred(name, "like", model.like)
            if base is None or not isinstance(base.desc, TextureDesc):
                return None
            width, height, format = base.desc.width, base.desc.height, format or base.desc.format
        if model.scale is not None:
            width, height = _scaled(width, model.scale), _scaled(height, model.scale)
        assert format is not None, "a texture has a format or is like another"
        mips = self._mips(name, model.mips, width, height)
        target = Target.D2_ARRAY if model.layers > 1 else Target.D2
        return TextureDesc(format, width, height, model.layers, mips, model.samples, target) if mips else None

    def _mips(self, name: str, mips: int, width: int, height: int) -> int | None:
        most = max(width, height).bit_length()
        if mips > most:
            self.findings.add(
                "RG308", "resources", name, "mips", resource=name, mips=mips, width=width, height=height, most=most
            )
            return None
        return mips or most

    def _within_limits(self, resource: Resource, loc: tuple[str, ...]) -> Resource | None:
        desc, name = resource.desc, resource.name
        if isinstance(desc, TextureDesc) and max(desc.width, desc.height) > MAX_SIZE:
            self.findings.add(
                "RG307", *loc, key=True, resource=name, width=desc.width, height=desc.height, limit=MAX_SIZE
            )
            return None
        if desc.bytes > MAX_BYTES:
            self.findings.add("RG313", *loc, key=True, resource=name, mib=desc.bytes >> 20, limit=MAX_BYTES >> 20)
            return None
        return resource

    # ---- image files

    def _image_file(self, name: str, model: ResourceModel, file: str) -> Resource | None:
        path = locate(self.findings.folder, file)
        size = self._read_size(name, file, path)
        if path is None or size is None:
            return None
        format = model.format or ("rgba16f" if path.suffix.lower() == ".hdr" else "srgb8_a8")
        if format not in REAL:
            self.findings.add("RG314", "resources", name, "format", resource=name, format=format)
            return None
        mips = self._mips(name, model.mips, *size)
        if mips is None:
            return None
        at = self.findings.document.position("resources", name, key=True)
        image = Resource(name, TextureDesc(format, *size, mips=mips), Kind.IMPORTED, file=path, position=at)
        return self._within_limits(image, ("resources", name))

    def _read_size(self, name: str, file: str, path: Path | None) -> tuple[int, int] | None:
        """Width and height in texels, or ``None`` after reporting why there are none."""
        loc: tuple[str, ...] = ("resources", name, "file")
        values: dict[str, Any] = {"resource": name, "file": file}
        if path is None:
            self.findings.add("RG311", *loc, folder=self.findings.folder, **values)
            return None
        try:
            if (problem := file_problem(self.findings.folder, file)) == MISSING:
                self.findings.add("RG310", *loc, folder=self.findings.folder, **values)
                return None
            if problem is not None:
                raise ValueError(f"it {problem}")
            width, height = image_size(path)
            if width < 1 or height < 1:
                raise ValueError(f"its size is {width} x {height}")
        except (OSError, ValueError) as error:
            reason = error.strerror or str(error) if isinstance(error, OSError) else str(error)
            self.findings.add("RG312", *loc, reason=reason, **values)
            return None
        return width, height

    def _check_histories(self) -> None:
        """Two histories of one resource would need two copies of the same content."""
        first: dict[str, str] = {}
        for name in sorted(name for name, found in self.resolved.items() if found and found.previous_of):
            found = self.resolved[name]
            source = found.previous_of if found else None
            if source is not None and first.setdefault(source, name) != name:
                self.findings.add(
                    "RG315", "resources", name, "previous", resource=name, other=first[source], source=source
                )


def _scaled(size: int, scale: float) -> int:
    """Rounded up, never below one texel: the rule of ``Builder.texture``."""
    return max(1, -int(-size * scale // 1))
