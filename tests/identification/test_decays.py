"""Free decays to F_k, c and K_z, on records of an integrator of another make."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.signal import lsim

from blind.decays import draw, record
from dampbalance import BaseMotion, Oscillator, identify, steady_orbit
from dampbalance.commands.main import main
from dampbalance.findings.finding import Finding
from dampbalance.identification.answer import USABLE
from dampbalance.identification.decays import identify_decay_records
from dampbalance.records.channel import Channel, Correction
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit, measured_ring_down
from dampbalance.records.writers import write
from dampbalance.signals.cycles import clipped, flat_tops
from identification.levels import SYMBOLS, changed, close
from identification.levels import clipped as cut
from identification.releases import FAR, PLUCKED
from signals.exact_decays import decay as exact_decay

QUANTITIES = ("displacement", "velocity", "acceleration")
OSCILLATOR = Oscillator(PLUCKED.m, PLUCKED.c, PLUCKED.k, PLUCKED.K_z, PLUCKED.F_k)
TWO = ("F_k", "c")


def noise_of(t):
    return np.random.default_rng(1).standard_normal(t.size)


def holds(result, decay):
    """Whether F_k, c and K_z of the fit, and of the balance where it has numbers, are those of the truth within their
    errors."""
    assert all(math.isfinite(value) for value in result.reference.values.values())
    for found in result.approaches.values():
        for symbol in TWO:
            off = found.values[symbol] - getattr(decay, symbol)
            assert not abs(off) >= FAR * found.standard_errors[symbol], symbol
    high, low = (1.0 / math.sqrt(end) for end in result.reference.K_z.interval)
    assert abs(decay.K_z**-0.5 - 0.5 * (low + high)) < FAR / 1.96 * 0.5 * (high - low)


@cache
def plucked(**options):
    """What a release of the oscillator gives."""
    return identify_decay_records([record(PLUCKED)[0]], PLUCKED.k, **options)


def test_the_motion_drawn_is_that_of_the_oscillator_where_a_hum_is_left_out_of_the_fit():
    decay = measured_ring_down(
        OSCILLATOR, x=0.01, rate_hz=1000.0, duration=2.0, noise=0.001, seed=5
    )
    table = decay.to_frame()
    table["displacement_m"] += 1e-4 * np.sin(2.0 * np.pi * 90.0 * table.index)
    found = identify(table, PLUCKED.k)
    assert found.basis.fit.problem.band is not None
    axes, below, *_ = found.plot("decays")
    samples, motion = (line.get_ydata() for line in axes.get_lines()[:2])
    # the hum has 28 times the frequency of the motion
    assert np.std(np.diff(motion, 3)) < 0.1 * np.std(np.diff(samples, 3))
    assert np.std(below.get_lines()[0].get_ydata()) > 1.0


@pytest.mark.parametrize("index", [10, 13])
def test_decays_do_not_overlap_and_none_is_that_of_a_hand(index):
    """Strikes of another seed, a hand pulling the mass from one to the next, which moves like half a cycle."""
    seed = 1795443154
    decay = draw(index, seed)
    measured, free = record(decay, seed)
    found = identify_decay_records([measured], decay.k)
    starts = [one.start for one in found.basis.fit.decays]
    np.testing.assert_allclose(starts, free, rtol=0, atol=0.1 * 2.0 * math.pi / decay.omega_n)
    ends = [one.end for one in found.basis.fit.decays]
    assert all(end <= start for end, start in zip(ends, starts[1:], strict=False))
    holds(found, decay)


def test_a_release_tells_friction_damping_and_contact():
    result, released = plucked(), record(PLUCKED)[1]
    holds(result, PLUCKED)
    fit, balance = result.basis.fit, result.estimates["balance"]
    assert fit.adequate
    # 1 % noise over 12 half cycles leaves 2 % to the fit
    assert fit.error("F_k") < 0.02 * PLUCKED.F_k
    assert fit.m == pytest.approx(PLUCKED.m, abs=FAR * fit.error("m"))
    # the balance leaves out the first and the last of 12 half cycles, and does not know where the spring is at rest
    assert balance.standard_errors["F_k"] < 0.08 * PLUCKED.F_k
    for symbol in TWO:
        error = result.reference.standard_errors[symbol]
        assert 1.0 < balance.standard_errors[symbol] / error < 10.0
    # χ² of rows that share half cycles: their covariance is full
    assert 0.1 < balance.misfit < 3.0
    # what held the mass before is left out: from the sample of the release on, and within an eighth of a cycle
    after = fit.decays[0].start - released[0]
    assert -1.0 / PLUCKED.rate_hz < after < 0.125 * 2.0 * math.pi / PLUCKED.omega_n


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_record_without_noise_gives_the_oscillator_back(quantity):
    options = {"rate_hz": 500.0, "duration": 5.0, "held": 0.2, "channels": (quantity,)}
    clean = measured_ring_down(OSCILLATOR, x=5e-3, **options)
    result = identify_decay_records([clean], OSCILLATOR.k)
    assert result.basis.fit.adequate
    for symbol in SYMBOLS:
        truth = getattr(OSCILLATOR, symbol)
        # where a climb ends: 1e-4 of the errors that the least noise assumed, 3e-6 of the swing, leaves: 3e-5 of c
        assert result.reference.values[symbol] == pytest.approx(truth, rel=1e-8)
        # smoothing over a twelfth of a cycle: 1e-4 of the swings, a tenth of which is lost in half a cycle; where an
        # acceleration jumps is known to a sample
        rel = 1e-2 if quantity == "acceleration" else 3e-3
        assert result.estimates["balance"].values[symbol] == pytest.approx(truth, rel=rel)


def test_records_go_together():
    records = [record(replace(PLUCKED, index=i))[0] for i in range(2)]
    all_of_them = identify_decay_records(records, PLUCKED.k)
    holds(all_of_them, PLUCKED)
    error, of_one = (each.basis.fit.error("F_k") for each in (all_of_them, plucked()))
    # the starts are found within a tenth of a cycle, the first tenth of the largest of 12 half cycles
    assert error / of_one == pytest.approx(2.0**-0.5, rel=0.12)
    assert len(all_of_them.sources) == 2


SCATTERING = (1.541, 1.599, 1.540, 1.344, 1.609)  # N, of five releases of one rig
RIG = replace(
    PLUCKED,
    **{"m": 2.42, "c": 4.0, "k": 2310.0, "K_z": 208000.0},
    **{"starts": (("pluck", 6e-3),), "lasts": (3.0,), "noise": 20e-6 / 6e-3},
)


def released(frictions):
    """What records of a release for each friction force give."""
    records = [record(replace(RIG, index=i, F_k=F_k))[0] for i, F_k in enumerate(frictions)]
    return identify_decay_records(records, RIG.k)


def test_releases_that_scatter_have_friction_forces_of_their_own():
    scattering = released(SCATTERING)
    assert not scattering.findings  # nothing is left out
    mean, scatter = float(np.mean(SCATTERING)), float(np.std(SCATTERING, ddof=1))
    answer = scattering.reference  # the balance has a row a decay, five for six unknowns
    assert answer.verdicts["F_k"].verdict == answer.verdicts["c"].verdict == USABLE
    p = answer.parameters["F_k"]
    # the forces of all five are known: the mean is theirs, to what the noise leaves
    assert p.value == pytest.approx(mean, abs=0.01)
    # Student's t of 4 degrees of freedom at 95 %, of which the noise adds little
    reach = 2.776 * scatter / math.sqrt(5)
    assert 0.5 * (p.interval.high - p.interval.low) == pytest.approx(reach, rel=0.1)
    assert close(answer, RIG, ("c", "K_z"))
    check = scattering.estimates["balance"].verdicts["F_k"]
    assert check.verdict == "none"
    assert "few half cycles" in {one.code for one in check.findings}
    document = scattering.document()
    decays = [decay for entry in document["records"] for decay in entry["decays"]]
    for decay, F_k in zip(decays, SCATTERING, strict=True):
        assert abs(decay["F_k_N"] - F_k) < FAR * decay["F_k_standard_error_N"]
    (said,) = (one.numbers for one in scattering.rig if one.code == "friction differs")
    assert [document["F_k_scatter_N"], said["scatter"]] == pytest.approx([scatter] * 2, rel=0.05)


def test_releases_that_share_a_friction_force_have_one():
    found = released([1.5] * 2)
    assert found.basis.fit.frictions.size == 1
    assert found.document()["F_k_scatter_N"] == 0.0


def struck(decay, instant, lasts):
    """The acceleration of a mass at rest that a hammer's half sine strikes an instant after the first sample, both
    times in cycles, by Euler's symplectic method, and its force."""
    period, finer = 2.0 * math.pi / decay.omega_n, 50  # 1 % of the noise
    limit, h = decay.F_k / decay.K_z, 1.0 / decay.rate_hz / finer
    since = (h * np.arange(round(8.0 * period / h)) - instant * period) / (lasts * period)
    half_sine = 0.1 * decay.m * math.pi / (2.0 * lasts * period) * np.sin(math.pi * since)
    push = np.where((since > 0.0) & (since < 1.0), half_sine, 0.0)
    a, x, v, z = np.empty_like(push), 0.0, 0.0, 0.0
    for i, force in enumerate(push.tolist()):
        a[i] = (force - decay.c * v - decay.k * x - decay.K_z * z) / decay.m
        v += h * a[i]
        x += h * v
        z = min(max(z + h * v, -limit), limit)
    a = a[::finer]
    return a + 1e-3 * np.abs(a).max() * noise_of(a), push[::finer]


# soon after the first sample, the middle of the pulse might be taken for a turn; volts are in no unit of a force:
# nothing says that it only strikes
@pytest.mark.parametrize(
    ("instant", "heading", "kind"),
    [(0.06, "Hammer [V]", "ring-down"), (1.0, "Hammer [N]", "recognised")],
)
def test_a_blow_is_no_obstacle_to_a_decay(instant, heading, kind):
    decay = replace(RIG, F_k=0.1)
    a, push = struck(decay, instant, 0.02)
    t = np.arange(a.size) / decay.rate_hz
    # noise of 1 % and the undershoot of a charge amplifier
    push += np.abs(push).max() * (
        0.01 * noise_of(a) - 0.005 * (t > t[np.argmax(push)]) * np.exp(-t)
    )
    found = identify({"time_s": t, "Acc [m/s²]": a, heading: push}, decay.k, kind=kind)
    assert found.basis.fit.adequate
    assert close(found, decay, ["F_k"])


@pytest.mark.parametrize(
    ("spc", "start", "quantity"),
    [(10, ("blow", 0.1), "velocity"), (16, ("pluck", 5e-3), "acceleration")],
)
def test_few_samples_a_cycle_suffice(spc, start, quantity):
    rate = spc * PLUCKED.omega_n / (2.0 * math.pi)
    decay = replace(PLUCKED, starts=(start,), answers=(quantity,), rate_hz=rate, noise=3e-3)
    found = identify_decay_records([record(decay)[0]], decay.k)
    assert found.basis.fit.adequate
    assert close(found, decay, TWO)


@pytest.mark.parametrize(("height", "lead"), [(3.6, 0.3), (5.2, 1.3)])
def test_a_decay_of_two_half_cycles_is_identified(height, lead):
    """The step from where the mass was held to where it stops has more energy than the motion between."""
    period = 2.0 * math.pi / PLUCKED.omega_n
    of = {"F_k": PLUCKED.k * 0.005 / height, "lead": (lead * period,), "lasts": (2.2 * period,)}
    decay = replace(PLUCKED, **of, noise=1e-3)
    found = identify_decay_records([record(decay)[0]], decay.k)
    assert close(found, decay, ["F_k"])
    assert found.standard_errors["F_k"] < 0.1 * decay.F_k


def closed_form(hertz, cycles, samples, order=0, noise=1e-3, m=0.1, **of):
    """A release from 1 mm without a contact spring, and its k, c and F_k."""
    k, t = m * (2.0 * math.pi * hertz) ** 2, np.arange(cycles * samples) / (samples * hertz)
    values = 1e-3 * exact_decay(t, hertz, of["zeta"], of["stick"], order)
    values += noise * np.abs(values).max() * np.random.default_rng(1).standard_normal(t.size)
    truth = {"c": 2.0 * of["zeta"] * math.sqrt(k * m), "F_k": 1e-3 * of["stick"] * k}
    return Record.of("closed form", [Channel(QUANTITIES[order], t, values)]), k, truth


def test_very_many_cycles_are_identified_from_excerpts():
    decay, k, truth = closed_form(2.8, 800, 13.7, zeta=4e-4, stick=5e-5)
    found = identify(decay, k, kind="ring-down")
    for symbol, value in truth.items():
        assert abs(found.values[symbol] - value) < FAR * found.standard_errors[symbol]
        assert found.standard_errors[symbol] < 0.1 * value
    assert found.natural_frequency == pytest.approx(2.8, rel=1e-5)


@pytest.mark.parametrize(("samples", "said"), [(150, "lower limit"), (100, "rings")])
def test_a_contact_without_a_spring_is_no_stiffness(samples, said):
    decay, k, _ = closed_form(11.5, 10, samples, 2, 5e-3, zeta=0.02, stick=0.03)
    verdict = identify_decay_records([decay], k).verdicts["K_z"]
    assert verdict.verdict != USABLE
    assert [one.code for one in verdict.findings] == [said]


def test_a_decay_without_a_stiffness_shows_its_damping():
    decay, _, _ = closed_form(2.8, 30, 50.0, zeta=5e-3, stick=2e-3)
    with pytest.raises(ValueError, match="stiffness") as refused:
        identify(decay)
    assert refused.value.__notes__


def test_a_weighed_mass_changes_no_number_that_the_decay_knows_better():
    """The decay knows the mass to far less than 0.3 %, and scales do not. One that is 30 % off is named."""
    mass = 1.003 * PLUCKED.m
    free, weighed = plucked(), plucked(mass=mass, mass_error=0.005)
    assert (weighed.values, weighed.verdicts) == (free.values, free.verdicts)
    # known to a millionth, it contradicts, and may move all numbers by 0.3 %: their intervals hold that, too
    exact = plucked(mass=mass, mass_error=1e-6)
    assert exact.values == free.values
    for symbol, ends in exact.intervals.items():
        value = free.values[symbol]
        reach = np.hypot(np.array(free.intervals[symbol]) - value, 0.003 * value)
        # the decay knows the mass to some 0.1 %, a few percent of this difference
        assert np.abs(np.array(ends) - value) == pytest.approx(reach, rel=0.05)
    wrong = plucked(mass=1.3 * PLUCKED.m)
    masses = (PLUCKED.m, 1.3 * PLUCKED.m)
    assert wrong.findings[0].numbers["masses"] == pytest.approx(masses, rel=0.01)
    assert min(one.mass_error for one in (weighed, wrong)) > 0.0  # the fit does not take it
    verdict = wrong.verdicts["F_k"]
    assert (verdict.verdict, verdict.findings) == ("doubtful", tuple(wrong.findings[:1]))
    # one that is right sharpens what follows from the heaviest model
    given = plucked(mass=PLUCKED.m).basis.fit
    assert given.m == PLUCKED.m
    assert given.error("rho") < free.basis.fit.error("rho")


def test_a_sensor_that_is_not_linear_is_left_for_the_band_of_the_mode():
    """x + 30|x|x, 15 % at the first peak: in all the band the samples are not those of the model."""
    measured, _ = record(replace(PLUCKED, noise=0.001))
    x = measured["displacement"].values
    bent = changed(measured, "displacement", values=x + 30.0 * np.abs(x) * x)
    assert identify_decay_records([bent], PLUCKED.k).basis.fit.problem.band is not None


def test_a_clipped_decay_is_named_and_its_samples_at_the_limit_left_out():
    sound = measured_ring_down(OSCILLATOR, x=0.005, rate_hz=200.0, duration=3.0, noise=0.005)
    found = identify([replace(cut(sound, "displacement", 0.5), name="decay")], OSCILLATOR.k)
    assert Finding("clipped decay", {"quantity": "displacement"}, of="decay") in found.findings
    for symbol in TWO:
        low, high = found.reference.intervals[symbol]
        assert low < getattr(OSCILLATOR, symbol) < high


@pytest.mark.parametrize("end", [1, -1])
def test_what_a_decay_begins_or_ends_at_is_not_clipped(end):
    t = np.arange(800) / 200.0
    decaying = np.exp(-t) * np.cos(20.0 * t)
    held = np.concatenate([np.full(50, 1.0), decaying, np.full(50, decaying[-1])])
    stopped = np.concatenate([decaying[:30], np.full(50, decaying[:30].min())])
    assert not any(clipped(of[::end]) for of in (decaying, held, stopped))
    for level in (0.9, 0.3):
        highest = level * decaying[20:].max()
        assert flat_tops(np.minimum(decaying, highest)[::end]) == (-np.inf, highest)
        assert clipped(np.maximum(decaying, level * decaying[20:].min())[::end])


def test_an_ac_coupling_that_is_stated_is_taken_off():
    """By SciPy, of first order at a tenth of the natural frequency."""
    measured = record(PLUCKED)[0]
    t, x = measured["displacement"].t, measured["displacement"].values
    y = lsim(([1.0, 0.0], [1.0, 2.0]), x - x[0], t)[1]
    coupling = Correction(high_pass=(-2.0 + 0j,))
    raw = changed(measured, "displacement", values=y, correction=coupling)
    found, plain = (
        identify_decay_records([raw.corrected()], PLUCKED.k).reference,
        plucked().reference,
    )
    assert close(found, PLUCKED, TWO)
    # in the band of the mode, from later on
    assert all(found.standard_errors[s] < 30.0 * plain.standard_errors[s] for s in TWO)


FEW = replace(draw(7, 77), answers=("acceleration",), noise=3e-3)
FEW = replace(FEW, rate_hz=4.0 * FEW.omega_n / (2.0 * math.pi))
NONE = "run: .* is missing .* no free decay .*"


def other(values):
    """What is said of a record with other values."""
    measured = replace(record(PLUCKED)[0], name="run")
    t, x = measured["displacement"].t, measured["displacement"].values
    changed_to = changed(measured, "displacement", values=values(t, x))
    return identify_decay_records([changed_to], PLUCKED.k)


@pytest.mark.parametrize(
    ("refused", "message"),
    [
        (lambda: other(lambda t, x: 1e-3 * np.sin(14.0 * t)), f"{NONE}as far at its end as at its"),
        (lambda: other(lambda t, x: noise_of(t)), f"{NONE}no oscillation in it exceeds the noise"),
        (lambda: other(lambda t, x: x[-1] + 1e-6 * noise_of(t)), f"{NONE}noise"),
        (lambda: identify_decay_records([record(FEW)[0]], FEW.k), r"has 3\.8 samples a cycle, 10"),
        (lambda: measured_ring_down(OSCILLATOR, rate_hz=9.0, duration=2.0), "needs a displacement"),
        (lambda: measured_ring_down(OSCILLATOR, rate_hz=9.0, duration=0.1, x=1.0), "2 are needed"),
    ],
)
def test_what_shows_no_decay_is_refused(refused, message):
    with pytest.raises(ValueError, match=message):
        refused()


def test_a_camera_that_follows_x_and_y_and_stamps_milliseconds_sees_a_decay():
    """In a free decay no base moves: y is the other axis."""
    decay = replace(PLUCKED, rate_hz=2000.0, lasts=(1.1,), noise=2e-3)
    t, x = record(decay)[0]["displacement"].t, record(decay)[0]["displacement"].values
    table = {"t (s)": np.round(t, 3), "x (m)": x, "y (m)": 0.3 * x}
    found = identify(table, decay.k, kind="ring-down")
    assert "resolution" in {key for one in found.findings for key in one.numbers}
    assert close(found, decay, ["F_k"])


def test_a_forced_record_is_not_taken_for_a_decay(tmp_path):
    path, free = tmp_path / "level.csv", tmp_path / "decay.csv"
    orbit = steady_orbit(OSCILLATOR, BaseMotion(2e-3, 0.7 * OSCILLATOR.omega_n))
    write(path, measured_orbit(orbit, rate_hz=500.0, cycles=60.0, noise=0.01, seed=0))
    write(free, record(PLUCKED)[0])
    together = r"level\.csv: .* moves: .* not identified together"
    for names, options, message in (
        ([path], {"kind": "ring-down"}, together),
        ([free, path], {}, together),
        ([path, free], {}, together),
        ([free], {"kind": "forced"}, r"decay\.csv: the excitation channel is missing"),
        ([free], {"frequency": 3.0}, "is for forced records"),
        ([free], {"skip_cycles": 2}, "is for forced records"),
    ):
        with pytest.raises(ValueError, match=message):
            identify(names, PLUCKED.k, **options)


def test_a_drive_that_stands_still_is_none():
    measured, _ = record(PLUCKED)
    t = measured["displacement"].t
    still = 1e-6 * np.random.default_rng(3).standard_normal(t.size)
    both = [Channel("base_displacement", t, still), measured["displacement"]]
    holds(identify([Record.of("run", both)], PLUCKED.k), PLUCKED)


def test_a_release_is_written_and_identified(tmp_path):
    path = tmp_path / "decay.csv"
    told = "--velocity 0.3 --damping 1 --friction 0.5 --noise 0.01 --rate 400 --seed 3"
    arguments = ["release", str(path), "--channel", "velocity", *told.split()]
    assert [main(arguments), main(arguments)] == [0, 2]  # the second finds the file there
    folder = tmp_path / "found"
    assert main(["identify", str(path), "--stiffness", "2310", "--output", str(folder)]) == 0
    written = {one.name for one in folder.iterdir()}
    assert {"decays.svg", "decays.png", "identification.json"} <= written


def test_a_motion_of_metres_is_doubted():
    """A millimetre read as a metre scales F_k, and only the size of the motion betrays it."""
    read = record(PLUCKED)[0]
    large = {q: replace(of, values=1e3 * of.values) for q, of in read.channels.items()}
    found = identify_decay_records([replace(read, channels=large)], PLUCKED.k)
    assert found.values["F_k"] == pytest.approx(1e3 * PLUCKED.F_k, rel=0.05)  # of the errors
    assert found.verdicts["F_k"].verdict != USABLE
    assert any(one.code == "implausible" for one in found.findings)
    assert not any(one.code == "implausible" for one in plucked().findings)
