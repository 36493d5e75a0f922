"""Everything that the article prints and did not type: the list of its values, and where each comes from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from ...balance import TERMS
from ...replication.claim_ids import PARTS
from ...replication.claim_verdicts import VERDICTS
from ...replication.comparison import WAY, WAYS
from . import recipe, tabulated
from .book import Book
from .noise import noise
from .places import ResultFiles
from .style import Style

EVIDENCE, ENVIRONMENT = "article/evidence.json", "article/environment.json"
SCHEMES, STUDIES = "article/schemes.csv", "article/studies.json"
APPROACHES_FILE = "tables/approaches.csv"

PLAIN, COUNT, WORD, TEXT = Style("plain"), Style("fixed"), Style("word"), Style("text")
PERCENT, DEVIATION, BOUND = Style("significant", 2), Style("power", 1), Style("bound")
SHIFT, SIGNED = Style("power", 2, signed=True), Style("significant", 2, signed=True)

# Study → the facts of its file that the article states
STUDY_FACTS = {
    "frequency": "band_common band_individual fourier fourier_c",
    "level": "c_low c_high low high off_low off_high fourier",
    "contact_stiffness": "soft paper rigid off_soft off_rigid soft_t fourier fourier_c",
    "damping": "light_off light_common fourier fourier_c",
    "read_out": "five six exact fourier_five fourier_six X_s_five X_s_six X_s_nine "
    "X_s_table_1_individual X_s_nine_individual",
    "step_size": "euler_paper euler_coarse explicit_paper rk4_coarse",
    "noise": "all_covered all_low all_high all_c_covered all_c_low all_c_high fourier_low X_s_covered "
    + " ".join(
        f"{fact}_{n}"
        for fact in ("F", "F_error", "equal", "fit", "fit_error", "simpson_bias", "simpson_c_bias")
        for n in (1, 2, 3)
    ),
    "rigid_contact": " ".join(
        ["c_from", "soft_omega1", "soft_omega3"]
        + [
            f"{fact}_{frequency}"
            for fact in ("F", "c", "pair_F", "fourier", "fourier_own", "X_s", "X_s_own", "from")
            for frequency in ("omega1", "omega2", "omega3")
        ]
    ),
}
# Study → the cases that the article puts into numbers: key → (fact, axis, power of ten, unit)
STUDY_CASES = {
    "level": {"lowest": ("c_low", "Y_m", "1e3", "mm"), "highest": ("c_high", "Y_m", "1e3", "mm")},
    "damping": {"above": ("light_off", "omega_over_omega_n", "1", "")},
    "step_size": {
        "as_published": ("euler_paper", "step_s", "1e6", "µs"),
        "coarsest": ("euler_coarse", "step_s", "1e6", "µs"),
    },
    "rigid_contact": {
        "soft": ("soft_omega1", "K_z_over_k", "1", ""),
        "paper": ("F_omega1", "K_z_over_k", "1", ""),
    },
}
# Study → the axis whose range the article states: power of ten, unit
STUDY_RANGES = {
    "frequency": ("omega_over_omega_n", "1", ""),
    "level": ("Y_m", "1e3", "mm"),
    "contact_stiffness": ("K_z_over_k", "1", ""),
    "damping": ("zeta", "1", ""),
}
FITS = {"pair": "{}_largest_pair_error_percent", "least_squares": "{}_error_percent"}


def article_values(
    results: ResultFiles, rules: Mapping[str, str], folder: str, frequencies: list[str]
) -> dict[str, Any]:
    """The values by key, the files they come from, and the lists over which the article's tables run.

    rules : result file → rule that makes it.   folder : of the results, e.g. results/paper.
    """
    book = Book(results, rules, folder)
    _setting(book, frequencies)
    _verdicts(book)
    _numerics(book, frequencies)
    recipe.enter(book, EVIDENCE)
    _off_resonance(book, frequencies)
    _studies(book)
    noise(book)
    lists = {
        **tabulated.tables(book),
        "claims": tabulated.claims(book),
        "verdicts": [asdict(verdict) for verdict in VERDICTS.values()],
        "frequencies": frequencies,
        "packages": _environment(book),
        **_software(book),
    }
    return book.as_json() | {"lists": lists}


def _setting(book: Book, frequencies: list[str]) -> None:
    """Parameters, frequencies, levels and numerics of the case."""
    for name, unit in {"m": "kg", "c": "N s/m", "k": "N/m", "K_z": "N/m", "F_k": "N"}.items():
        book.item(name, EVIDENCE, f"/setting/{name}", PLAIN, unit)
    book.item("zeta", EVIDENCE, "/setting/zeta", Style("fixed", 3))
    book.item("f_n", EVIDENCE, "/setting/natural_frequency_hz", Style("fixed", 4), "Hz")
    book.item("swing", EVIDENCE, "/setting/swing_um", Style("fixed", 3), "µm")
    for name in frequencies:
        book.item(f"f.{name}", EVIDENCE, f"/setting/frequency_hz/{name}", PLAIN, "Hz")
    levels = book.results.document(book.path(EVIDENCE))["setting"]["levels_mm"]
    for n in range(len(levels)):
        book.item(f"level.{n}", EVIDENCE, f"/setting/levels_mm/{n}", PLAIN)
    for name in ("levels", "frequencies", "pairs"):
        book.item(f"count.{name}", EVIDENCE, f"/setting/{name}", WORD)
    book.item("scheme", EVIDENCE, "/setting/scheme", TEXT)
    book.item("step", EVIDENCE, "/setting/step_us", PLAIN, "µs")
    book.item("c_over_m", EVIDENCE, "/setting/c_over_m", PLAIN, "s⁻¹")
    book.item("k_over_m", EVIDENCE, "/setting/k_over_m", PLAIN, "s⁻²")


def _verdicts(book: Book) -> None:
    for part in (*PARTS, "all"):
        for name in ("computed", *VERDICTS, "given", "statement", "statements_held"):
            book.item(f"verdicts.{part}.{name}", EVIDENCE, f"/verdicts/{part}/{name}", COUNT)


def _numerics(book: Book, frequencies: list[str]) -> None:
    """How the printed digits arose."""
    first = frequencies[0]
    book.item("added", EVIDENCE, "/dissipation/added", Style("fixed", 4), "N s/m")
    book.item("effective", EVIDENCE, "/dissipation/effective", Style("fixed", 4), "N s/m")
    for name in ("a", "b", "W"):
        book.item(f"dev.{name}", EVIDENCE, f"/integrals/{name}/printed/last", SHIFT)
    book.item("rebuilt.W", EVIDENCE, "/integrals/W/printed_from_rebuilt/max", DEVIATION)
    book.item(
        "rebuilt.b", EVIDENCE, "/integrals/b/printed_from_rebuilt_beyond_first/max", DEVIATION
    )
    book.item("rebuilt.b.first", EVIDENCE, "/integrals/b/printed_from_rebuilt_at_first", DEVIATION)
    book.item("rebuilt.a", EVIDENCE, "/integrals/a/printed_from_rebuilt/max", DEVIATION)
    book.item("unrounded.W", EVIDENCE, "/integrals/W/printed_from_unrounded/max", DEVIATION)
    for scheme in ("backward-euler", "explicit-euler", "trapezoidal", "rk4", "semi-implicit-euler"):
        row = {"scheme": scheme, "coefficients": "rounded", "level": "1"}
        book.cell(f"c.{scheme}", SCHEMES, row, "c_N_s_per_m", Style("fixed", 4), "N s/m")
    for quantity in TERMS:
        pointer = f"/two_point_largest/exact/{first}/{quantity}"
        book.item(f"worst.common.{quantity}", EVIDENCE, pointer, Style("significant", 4), "%")
        book.item(f"direct.{quantity}", EVIDENCE, f"/direct_largest/{quantity}", BOUND, "%")
    pointer = f"/two_point_largest/as_published/{frequencies[-1]}/F_k"
    book.item("worst.as_published", EVIDENCE, pointer, Style("significant", 3), "%")
    book.item("rebuilt.a.samples", EVIDENCE, "/slip_detected/size", PERCENT)
    for end in ("min", "max"):
        pointer = f"/step_from_W/{end}"
        book.item(f"step_from_W.{end}", EVIDENCE, pointer, Style("fixed", 3), "µs")
    book.item("cycles.count", EVIDENCE, "/cycles/count", COUNT)
    book.item("cycles.spread", EVIDENCE, "/cycles/spread", PERCENT)
    book.item("t_s_mean", EVIDENCE, "/setting/t_s_mean_ms", Style("fixed", 2), "ms")


def _off_resonance(book: Book, frequencies: list[str]) -> None:
    """Errors of F_k by each way at each frequency, and the terms of the balance that explain them."""
    book.item("W_fundamental", EVIDENCE, "/fundamental_work_largest", BOUND)
    for quantity in TERMS:
        book.item(f"fourier.largest.{quantity}", EVIDENCE, f"/fourier_largest/{quantity}", PERCENT)
    for frequency in frequencies:
        _errors(book, frequency)
        at = f"/balance/{frequency}"
        for end in ("first", "last"):
            book.item(f"share.{frequency}.{end}", EVIDENCE, f"{at}/friction_share/{end}", PERCENT)
            book.item(f"sine.{frequency}.{end}", EVIDENCE, f"{at}/sine/{end}", Style("fixed", 4))
            for name in ("W_individual", "W_common"):
                book.item(f"{name}.{frequency}.{end}", EVIDENCE, f"{at}/{name}/{end}", SIGNED)
        for phase in ("reversal", "fundamental"):
            pointer = f"{at}/phase_spread/{phase}"
            book.item(f"spread.{frequency}.{phase}", EVIDENCE, pointer, PERCENT)
        book.item(f"third.{frequency}", EVIDENCE, f"{at}/third/max", PERCENT)
        book.item(f"b_fifth.{frequency}", EVIDENCE, f"{at}/b_fifth/size", Style("significant", 1))


def _errors(book: Book, frequency: str) -> None:
    """Errors of F_k and c at a frequency: the size of the largest of the pairs, and of the least squares with sign."""
    for quantity in TERMS:
        for fit, column in FITS.items():
            for way, place in WAYS.items():
                row = {"frequency": frequency} | dict(zip(WAY, place, strict=True))
                exact, sized = way == "direct", fit == "pair"
                style = replace(BOUND if exact else PERCENT if sized else SIGNED, unsigned=exact)
                key = f"error.{frequency}.{way}.{fit}.{quantity}"
                book.cell(key, APPROACHES_FILE, row, column.format(quantity), style)
            key = f"error.{frequency}.lock_in.{fit}.{quantity}"
            style = PERCENT if fit == "pair" else SIGNED
            book.item(key, EVIDENCE, f"/lock_in/{frequency}/{fit}/{quantity}", style)


def _studies(book: Book) -> None:
    """The numbers of the parameter studies, in the words that their own pages use."""
    hundredfold = Style("plain", scale="1e2")
    book.item("within", STUDIES, "/frequency/specs/band_common/within", hundredfold, "%")
    for study, facts in STUDY_FACTS.items():
        book.item(f"cases.{study}", STUDIES, f"/{study}/cases", COUNT)
        for fact in facts.split():
            book.item(f"study.{study}.{fact}", STUDIES, f"/{study}/facts/{fact}", TEXT)
        if study in STUDY_RANGES:
            axis, scale, unit = STUDY_RANGES[study]
            for place, end in enumerate(("low", "high")):
                pointer, style = f"/{study}/ranges/{axis}/{place}", Style("plain", scale=scale)
                book.item(f"range.{study}.{end}", STUDIES, pointer, style, unit)
        for name, (fact, axis, scale, unit) in STUDY_CASES.get(study, {}).items():
            pointer = f"/{study}/specs/{fact}/at/{axis}"
            book.item(f"case.{study}.{name}", STUDIES, pointer, Style("plain", scale=scale), unit)


def _environment(book: Book) -> list[str]:
    """The versions of Python that are needed, of typst itself, and of the packages that matter."""
    packages = list(book.results.document(book.path(ENVIRONMENT))["packages"])
    book.item("python", ENVIRONMENT, "/python", TEXT)
    book.item("typesetter", ENVIRONMENT, "/typesetter", TEXT)
    for name in packages:
        book.item(f"package.{name}", ENVIRONMENT, f"/packages/{name}", TEXT)
    return packages


def _software(book: Book) -> dict[str, list[str]]:
    """Version, licence, authors and addresses as CITATION.cff states them; return which authors and addresses."""
    stated = book.results.document(book.path(ENVIRONMENT))["software"]
    for name in ("version", "licence"):
        book.item(f"software.{name}", ENVIRONMENT, f"/software/{name}", TEXT)
    for n in range(len(stated["authors"])):
        book.item(f"author.{n}", ENVIRONMENT, f"/software/authors/{n}", TEXT)
    for name in stated["addresses"]:
        book.item(f"software.{name}", ENVIRONMENT, f"/software/addresses/{name}", TEXT)
    return {"authors": stated["authors"], "addresses": list(stated["addresses"])}
