"""Where the project under test stands."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[1]
PUBLISHED = ROOT / "paper/published"
PAPER_FILE = ROOT / "config/config.yaml"
STUDY_SCHEMA = ROOT / "workflow/schemas/study.schema.yaml"
