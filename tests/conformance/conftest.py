"""Packages of nodes made for one test, found as other people's are."""

from tests.measure.truth.conftest import install

__all__ = ["install"]
