"""What is compared with does not leak into what is computed: only claims code reads the printed numbers."""

from __future__ import annotations

import re

from folders import ROOT

# A file refers to the printed numbers when it names their folder, the configuration key that holds it, the package that
# reads them, or its functions. To ask whether there is anything to compare with is no reference; nor is a
# verdict's name.
REFERENCE = re.compile(
    r"paper/published"
    r"|(?<!if config\[)['\"]published['\"]"
    r"|published_files|read_published|from \.+ import .*\bclaims\b"
    r"|(?:dampbalance\.|from \.+)(?:replication\.)?claims(?!\.verdicts import| import verdicts)"
)

# Claims code and its rules, the article, which prints what they found; the configuration names the key.
ALLOWED = (
    "src/dampbalance/replication/claims/",
    "src/dampbalance/publishing/article/derived_numbers.py",
    "workflow/scripts/article/article_numbers.py",
    "workflow/rules/claims.smk",
    "workflow/scripts/claims/claims.py",
    "workflow/scripts/claims/check.py",
    "workflow/scripts/claims/numbers.py",
    "config/config.yaml",
)


def sources():
    """Everything that computes: package, workflow, Snakefile, configurations."""
    found = [*ROOT.glob("Snakefile"), *ROOT.glob("config/**/*.yaml")]
    for folder in ("src", "workflow"):
        found += [p for p in (ROOT / folder).rglob("*") if p.suffix in (".py", ".smk", ".yaml", "")]
    return sorted(p for p in found if p.is_file() and "__pycache__" not in p.parts)


def named(path):
    return path.relative_to(ROOT).as_posix()


def test_only_claims_refer_to_the_printed_numbers():
    others = [path for path in sources() if not named(path).startswith(ALLOWED)]
    assert "src/dampbalance/balance.py" in map(named, others)
    for name in ("src/dampbalance/replication/claims/printed.py", *ALLOWED[1:]):  # it sees a leak
        assert REFERENCE.search((ROOT / name).read_text(encoding="utf-8")), name
    found = {named(path): REFERENCE.findall(path.read_text(encoding="utf-8")) for path in others}
    assert {name: leaks for name, leaks in found.items() if leaks} == {}


def test_no_printed_estimate_is_typed_into_the_sources():
    """The digits of the printed results: long enough not to stand anywhere by chance."""
    digits = [
        "90.0115", "1.279987", "9.1587", "1.284786", "1.285022", "1.285163", "0.07939719", "0.010885625",
        "0.19139123", "0.35158214", "0.55996992", "0.81655453", "1.279799", "1.280015", "1.280030",
    ]  # fmt: skip
    for path in sources():
        text = path.read_text(encoding="utf-8")
        assert not [number for number in digits if number in text], path
