"""Answers to measured loops, with and without times, against closed forms; and what is not determined."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from dampbalance import BaseMotion, Oscillator, identify, identify_loops, steady_orbit
from dampbalance.identification import loops
from dampbalance.identification.outputs import outputs_of
from dampbalance.identification.sensitivities import Fault
from dampbalance.law.contact import play
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from fit.test_loops import F_K, K_Z, SINE, TRIANGLE, C, K, T, X, loop, stepped
from records.drafts import filled, shown

GROWN = np.repeat([0.4, 0.7, 1.0], 2500) * SINE[:7500]
LOSS = 4.0 * F_K * (X - F_K / K_Z)
"""Work of a cycle of the slider."""


def fit_of(found):
    """The fit of the answer."""
    return found.basis.fits[found.answer.name]


def table(x=SINE, **more):
    return in_time(x, loop(x, **more).f)


def in_time(x, force, t=T):
    return {"time_s": t, "displacement_m": x, "force_N": force}


def written(folder, head, *columns):
    """A file of a test machine."""
    file = folder / "loops.csv"
    np.savetxt(file, np.column_stack(columns), delimiter=",", header=head, comments="")
    return file


def untimed(folder, x, force):
    return written(folder, "displacement (mm),force (kN)", 1e3 * x, 1e-3 * force)


def noise(seed, part=0.01, size=T.size):
    """A part of the friction force."""
    return part * F_K * np.random.default_rng(seed).normal(size=size)


def holds(found, **truth):
    """The intervals hold the truth, and the verdicts are those of numbers that can be used."""
    for symbol, true in truth.items():
        low, high = found.intervals[symbol]
        assert low < true < high, symbol
        assert found.verdicts[symbol].verdict == "usable"


def near(found, **truth):
    """Within five standard errors, which are exceeded once in 20,000 cases of 18 degrees of freedom."""
    fit = fit_of(found)
    for symbol, true in truth.items():
        assert abs(fit.value(symbol) - true) < 5.0 * fit.error(symbol), symbol


def codes(found):
    return [one.code for one in found.answer.notes]


@pytest.fixture(scope="module")
def sound():
    return identify(table())


def test_loops_are_recognised_by_force_and_displacement_without_a_stiffness(sound, tmp_path):
    assert sound.options["kind"] == "loops"
    holds(sound, F_k=F_K, K_z=K_Z)
    near(sound, c=C)
    assert {path.name for path in sound.save(tmp_path)} == {*outputs_of("loops")}
    assert sound.document()["history"]["X_m"][0] == pytest.approx(X, rel=1e-3)


# --- levels, cycles, and what has no times ---------------------------------------------------------


def test_levels_have_the_loss_stiffness_damping_and_backbone_of_a_slider_and_a_spring():
    """W = 4F_k(X − Z), k_s = F_k/X + k, ζ_eq = W/(2π k_s X²), a force of F_k + kX at X."""
    force = K_Z * stepped(GROWN, F_K / K_Z) + K * GROWN + 5.0
    levels = identify_loops(in_time(GROWN, force, T[:7500])).levels
    shown = [level.document(math.nan, math.nan) for level in levels]
    assert [one["cycles"] for one in shown] == [4, 5, 5]  # the first cycle begins at rest
    for part, one in zip((0.4, 0.7, 1.0), shown, strict=True):
        x = part * X
        W, k_s = 4.0 * F_K * (x - F_K / K_Z), F_K / x + K
        true = {"X_m": x, "W_over_4X_N": W / (4.0 * x), "secant_stiffness_N_per_m": k_s}
        true |= {"W_J": W, "equivalent_damping_ratio": W / (2.0 * math.pi * k_s * x**2)}
        true |= {"loss_factor": W / (math.pi * k_s * x**2), "frequency_Hz": 1.0}
        for end, way in (("largest", 1.0), ("smallest", -1.0)):
            true[f"{end}_displacement_m"] = way * x
            true[f"force_at_{end}_displacement_N"] = way * (F_K + K * x) + 5.0
        for key, value in true.items():
            assert one[key] == pytest.approx(value, rel=0.012), key


def test_without_times_nothing_has_a_time(tmp_path):
    record = loop(c=0.0)
    timed = identify_loops(in_time(SINE, record.f))
    found = identify(untimed(tmp_path, SINE, record.f))
    holds(found, F_k=F_K, K_z=K_Z)
    assert [one.code for one in found.verdicts["c"].findings] == ["no times"]
    for own, other in zip(found.levels, timed.levels, strict=True):
        ratio = other.more["equivalent_damping_ratio"]
        assert own.more["equivalent_damping_ratio"] == pytest.approx(ratio, rel=1e-3)
    said = found.text() + found.screen() + repr(found.records[0])
    assert not [unit for unit in (" Hz", " s ", "N s/m =", "m/s") if unit in said]
    found.save(tmp_path / "out")


@pytest.mark.parametrize(("swapped", "sign"), [(True, 1.0), (False, -1.0)])
def test_two_columns_are_asked_for_what_they_lack(tmp_path, swapped, sign):
    """Which of them lies ahead of the other one follows from the sign of the force as well."""
    columns = SINE, sign * loop(c=0.0).f
    file = written(tmp_path, "", *columns[:: -1 if swapped else 1])
    with pytest.raises(ValueError, match="hold: displacement or force") as refused:
        identify(file)
    chosen = {"displacement": f"column {1 + swapped}", "force": f"column {2 - swapped}"}
    mapping = filled(shown(refused.value), chosen, units={"displacement": "m", "force": "N"})
    assert identify(file, mapping=mapping).values["F_k"] == pytest.approx(F_K, rel=0.01)


@pytest.mark.parametrize(("drift", "known"), [(0.1, True), (1.5, False)])
def test_a_motion_whose_mean_drifts_by_more_than_its_amplitude_has_none(drift, known):
    x = SINE + drift * X * T  # in a cycle of 1 s
    for level in identify_loops(in_time(x, K_Z * stepped(x, F_K / K_Z))).levels:
        shown = level.document(math.nan, math.nan)
        assert shown["W_J"] > 0.0
        for key in ("X_m", "secant_stiffness_N_per_m", "equivalent_damping_ratio"):
            assert math.isnan(shown[key]) != known


def test_times_are_asked_for_where_a_motion_needs_them(tmp_path):
    with pytest.raises(ValueError, match="has no times, which forced records need"):
        identify(untimed(tmp_path, SINE, loop().f), stiffness=2310.0)


def test_few_cycles_have_their_levels_and_no_fit(tmp_path):
    x, cycles = SINE[:2001], 4
    found = identify(untimed(tmp_path, x, K_Z * stepped(x, F_K / K_Z)), normal_force=20.0)
    assert codes(found) == ["few loops"]
    assert found.no_answer
    history = loops.loop_history(found)
    assert len(history) == len(found.rows) == cycles
    # a quarter of the first cycle is that from rest: half of the stick distance less is travelled
    np.testing.assert_allclose(history["W_J"][1:], LOSS, rtol=2e-3)
    assert 0.9 < history["W_J"][0] / LOSS < 1.0
    assert history["F_k_N"].isna().all()


def test_rest_drift_and_skipped_cycles(tmp_path):
    rest = np.concatenate([np.zeros(1100), SINE, np.full(900, SINE[-1])])
    for x, skipped in ((rest, 0), (SINE + 0.05 * X * T, 3)):
        file = untimed(tmp_path, x, K_Z * stepped(x, F_K / K_Z) + noise(7, size=x.size))
        found = identify(file, skip_cycles=skipped)
        near(found, F_k=F_K, K_z=K_Z)
        cycles = loops.loop_history(found)
        assert cycles["cycle"].iloc[0] == 1 + skipped
        np.testing.assert_allclose(cycles["W_J"][1:], LOSS, rtol=0.04)
    with pytest.raises(ValueError, match=r"complete cycles, .* and 41 are needed"):
        identify(file, skip_cycles=40)


def test_the_history_follows_friction_and_stiffness_that_fall():
    fall = np.where(T < 10.0, 1.0, 0.8)
    z, force = 0.0, []
    for part, dx in zip(fall, np.diff(SINE, prepend=0.0), strict=True):
        z = min(max(z + K_Z * part * dx, -F_K * part), F_K * part)
        force.append(z)
    history = loops.loop_history(identify_loops(in_time(SINE, np.array(force))))
    assert math.isnan(history["F_k_N"].iloc[0])  # what the contact held before is not known
    for name in ("F_k_N", "K_z_N_per_m"):
        of = history[name].to_numpy()
        # one step of Gauss and Newton from the mean: second order in ±10 %
        assert np.median(of[-5:]) / np.median(of[1:6]) == pytest.approx(0.8, abs=0.02)


# --- normal force, fixture, and laws beyond the slider ---------------------------------------------


def test_the_friction_coefficient_has_the_uncertainties_of_both_forces():
    found = identify_loops(table(), normal_force=(20.0, 1.0))
    mu, (low, high) = loops.friction_coefficient(found)
    assert mu == pytest.approx(0.5, rel=0.01)
    assert 0.5 * (high - low) == pytest.approx(1.96 * 0.5 / 20.0, rel=0.05)  # that of N dominates


def test_a_channel_of_the_normal_force_gives_the_friction_coefficient_of_each_cycle(tmp_path):
    """Read from a file by its heading; N grows by a tenth, and so does the friction."""
    N = 20.0 * (1.0 + 0.1 * T / T[-1])
    force = table(c=0.0)["force_N"] * N / 20.0
    head = "t (s),x (m),Friction (N),Normal (N)"
    found = identify(written(tmp_path, head, T, SINE, force, N))
    mu, (low, high) = loops.friction_coefficient(found)
    assert low < 0.5 < high
    assert mu == pytest.approx(0.5, rel=0.01)
    mu = loops.loop_history(found)["friction_coefficient"]
    # the spring in parallel and the offset grow with N here, and are not friction: 3 % of F_k
    assert mu.min() == pytest.approx(0.5, rel=0.03) == mu.max()


def at_two_loads(mu=None):
    """Loops of 9 and 10 N, with the normal force where μ is given."""
    for seed, F in enumerate((9.0, 10.0)):
        record = table(contact=((K_Z, F / K_Z),), seed=seed, c=0.0)
        if mu:
            record["normal_force_N"] = F / mu * (1.0 + noise(seed, 0.005 / F_K))
        yield record


def test_records_at_two_normal_loads_share_a_friction_coefficient():
    found = identify_loops([*at_two_loads(mu=0.5)])
    (low, high), mu = found.intervals["F_k"], loops.friction_coefficient(found)
    assert low < 9.5 < high < low + 0.1  # that at the mean normal force
    assert mu[1].low < 0.5 < mu[1].high
    assert "F_k is that at N = 19" in found.text()
    cycles = loops.loop_history(found).groupby("record")["F_k_N"].mean()
    np.testing.assert_allclose(cycles, [9.0, 10.0], rtol=0.01)
    near(found, c=0.0, K_z=K_Z)


def test_friction_that_differs_from_record_to_record_is_in_the_interval():
    """Where the loads are not known, as for releases: the mean, with the scatter of few records."""
    found = identify_loops([*at_two_loads()])
    low, high = found.intervals["F_k"]
    assert low < 9.0 < 10.0 < high
    assert found.values["F_k"] == pytest.approx(9.5, rel=2e-3)
    assert found.values["K_z"] == pytest.approx(K_Z, rel=5e-3)
    assert found.verdicts["F_k"].verdict == "doubtful"
    assert "The friction force differs from record to record" in found.text()
    alike = identify_loops([table(c=0.0), table(seed=1, c=0.0)])
    assert "differs from record" not in alike.text()


def test_a_fixture_in_series_makes_the_contact_look_softer():
    stiff = identify_loops(table(c=0.0), fixture_stiffness=2e5)
    # springs in series: 1/K_z + 1/k_s of the fixture is what the loop shows; the spring k adds 1 %
    assert 1.0 / (1.0 / stiff.values["K_z"] + 1.0 / 2e5) == pytest.approx(K_Z, rel=0.03)


def test_the_contact_goes_into_a_response(sound):
    motion = BaseMotion(Y=0.01, omega=30.0)
    laws = loops.loop_contact(sound), {"F_k": F_K, "K_z": K_Z, "c": C}
    one, other = (steady_orbit(Oscillator(m=2.0, k=2310.0, **law), motion).X for law in laws)
    assert one == pytest.approx(other, rel=0.02)  # F_k within 1 %, c within a third of little


def stepped_with_speed(top, x=SINE):
    """Force of a slider of K_z whose friction follows top(ẋ), sample by sample, with 1 % of noise."""
    v, force = np.gradient(x, T), np.zeros(T.size)
    for i in range(1, T.size):
        limit = top(v[i])
        force[i] = min(max(force[i - 1] + K_Z * (x[i] - x[i - 1]), -limit), limit)
    return force + noise(3), v


def test_a_friction_that_falls_with_the_speed_is_identified():
    v_S = 0.3 * 2.0 * np.pi * X
    force, _ = stepped_with_speed(lambda v: F_K * (1.0 + 0.4 * math.exp(-((v / v_S) ** 2))))
    found = identify_loops(in_time(SINE, force))
    holds(found, F_k=F_K, K_z=K_Z)
    near(found, F_S=0.4 * F_K, v_S=v_S)
    assert "The friction falls with the speed" in found.text()


def test_a_quadratic_damper_and_a_moving_mass_are_identified():
    """Two frequencies are needed: at one, m ẍ is a spring."""
    records = []
    for omega in (2.0 * np.pi, 4.0 * np.pi):
        x = X * np.sin(omega * T)
        force, v = stepped_with_speed(lambda v: F_K, x)
        record = in_time(x, force + 3e4 * v * np.abs(v) - 20.0 * omega**2 * x)
        records.append({name: of[: T.size // 3] for name, of in record.items()})
    found = identify_loops(records)
    near(found, F_k=F_K, K_z=K_Z, c=0.0, c_2=3e4, m=20.0)
    assert "A quadratic damper of c_2" in found.text()


def test_a_rounded_knee_is_named_and_goes_into_a_response_as_sliders():
    z, n, force = 0.0, 2.0, []
    for dx in np.diff(np.interp(np.arange(0.0, T[-1], 5e-5), T, SINE), prepend=0.0):
        z += K_Z / F_K * dx * (1.0 - abs(z) ** n * (z * dx > 0.0))
        force.append(F_K * z)
    f = np.array(force)[:: round(T[1] / 5e-5)][: T.size - 1]
    found = identify_loops(in_time(SINE[:-1], f + noise(4, size=f.size), T[:-1]))
    near(found, F_k=F_K, K_z=K_Z, n=n)
    assert "The knee of the loop is rounded" in found.text()
    # the same loss as the contact at the amplitude of the record, by sliders of the gradual contact
    r, kappa = loops.loop_sliders(found)["r"], loops.loop_sliders(found)["kappa"]
    lost = 4.0 * float(np.maximum(X - r, 0.0) @ (kappa * r))
    assert lost == pytest.approx(np.trapezoid(f[-500:], SINE[:-1][-500:]), rel=0.01)


def test_the_loss_of_another_amplitude_is_predicted():
    found = identify_loops([table(), table(0.5 * SINE)])
    X_new = np.array([0.3, 0.8, 1.2]) * X
    W, error = fit_of(found).loss(found.basis.loops[0], X_new)
    # 4F_k(X − Z_m) + πcωX² of a sine
    true = 4.0 * F_K * (X_new - F_K / K_Z) + math.pi * C * 2.0 * math.pi * X_new**2
    # noise of 1 %, and a cycle that does not start at its end
    assert np.abs(W / true - 1.0).max() < 0.005
    assert (np.abs(W - true) < 6.0 * error).all()


# --- what is not determined, and records with faults -----------------------------------------------


def test_what_is_not_determined_is_said():
    found = identify_loops(pd.DataFrame(table(TRIANGLE))[:3000])
    assert math.isnan(found.values["c"])
    assert [one.code for one in found.verdicts["c"].findings] == ["one speed"]
    stuck = identify_loops(pd.DataFrame(table(0.15 * SINE, noise=1e-3))[:3000])
    assert stuck.no_answer
    assert codes(stuck) == ["loops stick"]


def test_another_shape_has_a_wide_interval_with_a_reason_and_noise_is_none():
    odd = table(c=0.0)
    odd["force_N"] = odd["force_N"] * np.where(odd["force_N"] > 0.0, 1.6, 1.0)
    odd["force_N"] += 4.0 * np.sin(14.0 * np.pi * T)
    found = identify_loops(odd)
    # of 16 and 10 N the mean, and the residual of 4 N beside the slider counts
    low, high = found.intervals["F_k"]
    assert low < 13.0 < high
    assert found.verdicts["F_k"].within > 0.05
    assert codes(found) == ["other shape"]
    loud = identify_loops(in_time(SINE, loop(noise=0.08, seed=3).f))
    assert "other shape" not in codes(loud)
    holds(loud, F_k=F_K)


def test_a_stiffness_that_noise_hides_has_no_limit_below_zero():
    t = np.arange(0.0, 7.0, 1.0 / 60.0)
    x = X * np.sin(2.0 * np.pi * t)
    # value less half an interval is negative
    force = F_K / (0.05 * X) * stepped(x, 0.05 * X) + noise(0, 1.0, t.size)
    assert identify_loops(in_time(x, force, t)).intervals["K_z"].low > 0.0


def by_mapping(record, **rule):
    """What is found with a rule for the force."""
    channels = {"force": {"channel": "force_N", **rule}}
    mapping = {"channels": {**channels, "displacement": {"channel": "displacement_m"}}}
    return identify_loops(record, mapping=mapping)


def test_uncertainties_of_gain_and_delay_widen_the_intervals():
    """By what such faults do, which is what records that have them change by, see `test_sensitivities.py`."""
    record = table(c=30.0)
    rules = {}, {"gain_uncertainty": 0.02}, {"delay_uncertainty": 1e-3}
    plain, gain, delay = (by_mapping(record, **rule) for rule in rules)
    told = plain.shifts({"late": Fault("", late=1e-3)}, plain.answer.name)["late"]
    for symbol, value in plain.values.items():
        own, by_gain, by_delay = (
            0.5 * np.diff(of.intervals[symbol])[0] for of in (plain, gain, delay)
        )
        assert by_gain == pytest.approx(math.hypot(own, 1.96 * 0.02 * value), rel=1e-3)
        # half of the interval of K_z, which is not symmetrical about it
        assert by_delay == pytest.approx(math.hypot(own, 1.96 * told[symbol] * value), rel=5e-3)
    assert delay.values == gain.values == plain.values


def test_time_in_which_a_channel_is_missing_is_left_out_and_said():
    def channels(until, start=0.0):
        force = Channel("force", T[:until] + start, table()["force_N"][:until])
        return Record.of("x", [force, Channel("displacement", T, SINE)])

    found = identify_loops(channels(T.size // 2))
    holds(found, F_k=F_K)
    assert "10 s are left out, in which not all of displacement and force" in found.text()
    with pytest.raises(ValueError, match="x: displacement and force are not recorded at the same"):
        identify_loops(channels(T.size, start=100.0))


def test_loops_of_velocity_are_recognised_and_the_guess_is_said():
    record = table()
    record["velocity_m_per_s"] = np.gradient(record.pop("displacement_m"), T)
    found, stated = identify(record), identify(record, kind="loops")
    assert found.values["F_k"] == pytest.approx(F_K, rel=5e-3)
    words = "give its stiffness (stiffness=…): they are forced records then"
    assert [words in of.text() for of in (found, stated)] == [True, False]


def test_a_long_record_is_fitted_in_runs_of_cycles(monkeypatch):
    """Cycles of the runs are those of the record; the history is of all of them."""
    monkeypatch.setattr(loops, "MOST_SAMPLES", 4000)
    t = np.arange(0.0, 200.0, 0.01)
    x = X * np.sin(2.0 * np.pi * t)
    force = K_Z * play(x, F_K / K_Z)[0] + noise(5, size=t.size)
    found = identify_loops(in_time(x, force, t))
    (loop,) = fit_of(found).design.loops
    assert loop.own.size == pytest.approx(4000, rel=0.25)
    np.testing.assert_allclose(loop.amplitudes, X, rtol=2e-3)
    assert len(loops.loop_history(found)) == found.basis.loops[0].cycles == 199
    # the corner between samples makes 0.1 %
    assert [found.values[s] for s in ("F_k", "K_z")] == pytest.approx([F_K, K_Z], rel=2e-3)
    assert "is fitted to 48 of the 198 cycles" in found.text()
    np.testing.assert_allclose(loops.loop_history(found)["F_k_N"][1:], F_K, rtol=0.02)
