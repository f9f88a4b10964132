"""Without the compiled package all but the engine works, and the engine says what is missing."""

import sys

import pytest

import skyglow


def test_a_missing_package_is_named(monkeypatch):
    # None in the table of modules makes an import fail, whether the package is installed or not.
    monkeypatch.setitem(sys.modules, "skyglow_engine", None)
    with pytest.raises(ImportError, match="skyglow-engine"):
        skyglow.Engine()
