"""The one table of findings: code → sentence, remedy, section of the site. `words` says how templates are filled."""

from __future__ import annotations

from collections.abc import MutableMapping
from typing import NamedTuple


class Sentence(NamedTuple):
    """What a finding says.

    words : what it is and how large, a template.   remedy : what helps, a template; empty where nothing does or the
    words say it.   page : the section of the site's page of symptoms that explains it.   spares : names of the answers
    that it does not concern.
    """

    words: str
    remedy: str = ""
    page: str = ""
    spares: tuple[str, ...] = ()


_GRADUALLY = "yields gradually (Dahl, Bouc–Wen, several contacts)"
_UNSURE = "[unsure? (a size that the records do not determine)]"
_STATICALLY = (
    "Measure it statically: hang known weights on the {mass} with the contact loose, and take the slope of {force} "
    "over {displacement}."
)

_BASE = Sentence(
    "[by_force?the {force}|the base motion] is not harmonic: {distortion:percent} distortion, most of it harmonic "
    "{order:.0f} ({share:percent}); a fit to the fundamentals leaves its other harmonics out",
    page="base",
    spares=("direct", "maximum likelihood"),
)

SENTENCES: MutableMapping[str, Sentence] = {
    # --- a record: how it was read -----------------------------------------------------------------
    "as read": Sentence("{words}"),
    "rounded times": Sentence(
        "{where} is rounded to {resolution:.3g s} at steps of {step:.3g s}: a straight line through it gives "
        "{rate:.9g} samples a second, to within {bound:.3g ppm}",
        "give sample_rate_hz if known",
    ),
    "uneven times": Sentence(
        "{channel}: times are up to {off:percent} of a step off equal steps, which are used instead"
    ),
    "several levels": Sentence(
        "a level of {levels:.0f} in one file, which is split at the steps of its drive"
    ),
    "cut off": Sentence("{lost:.4g s} are left out, in which not all of {channels} are recorded"),
    # --- a record: its signals ---------------------------------------------------------------------
    "few cycles": Sentence(
        "only {cycles:.0f} cycles: standard errors and intervals are rough; record {enough:.0f} or more"
    ),
    "spikes": Sentence(
        "{quantity}: {count:.0f} of its cycles left out, beginning with cycle {first:.0f} (at {time:.6g s}): {why}",
        page="spikes",
    ),
    "gap": Sentence("samples are missing"),
    "spike": Sentence("a spike: {value:.6g} where {expected:.6g} is expected"),
    "drop-out": Sentence("a drop-out: {samples:.0f} samples hold the value {value:.6g}"),
    "clipped": Sentence(
        "{quantity} is clipped: in {cycles:.0f %} of the cycles several samples hold the extreme value; amplitude and "
        "harmonics are too small",
        "raise the measuring range, unless the {mass} stops there",
        page="clipped",
    ),
    "clipped decay": Sentence(
        "{quantity:noun} is clipped: several samples are at its extreme value and are left out",
        "raise the measuring range",
        page="clipped",
    ),
    "left out": Sentence(
        "a channel is clipped: the record is left out", "raise the measuring range", page="clipped"
    ),
    "bits": Sentence(
        "{quantity} has {bits:.1f} effective bits, below 12, and its noise is less than half a step: the rounding "
        "error repeats in each cycle, and standard errors miss it",
        "lower the measuring range",
        page="bits",
    ),
    "frequency": Sentence(
        "the excitation oscillates at {measured:.7g} ± {error:.1g} Hz, not at the {given:.7g} Hz given ({off:ppm}): "
        "the given one was rounded, or the clock of the generator or the recorder is off; the measured frequency is "
        "used",
        page="frequency",
    ),
    "other frequency": Sentence(
        "the excitation oscillates at {measured:.6g} ± {error:.1g} Hz, not at the {given:.6g} Hz given: wrong "
        "frequency, wrong column, or a wrong sampling rate"
    ),
    "starts late": Sentence("{quantity} stands still until {begin:.4g s}: left out"),
    "settles": Sentence(
        "the motion settles after {cycles:.0f} cycles: they are left out, as --skip-cycles does"
    ),
    "unsettled": Sentence(
        "the [drive?excitation|response] is not steady: its amplitude changes by {change:percent}, its phasor by up "
        "to {turn:percent} during the record (chance of that in noise: {chance:chance})[phase?; only its phase "
        "drifts, as with two sampling clocks or growing friction]",
        "[after?it settles after about {after:.0f} cycles: leave those out (--skip-cycles {skip:.0f})]"
        "[large?leave out cycles at its start (--skip-cycles), or record again after the motion has settled]",
        page="unsettled",
    ),
    "late": Sentence(
        "{quantity} [lags?lags|leads] {other} by {by:.1f µs} ± {error:.1g µs}: shifted to agree; a record cannot show "
        "whether the excitation is in time with either"
    ),
    "scaled": Sentence(
        "{quantity} shows {gain:.5f} times the motion of {other}: scaled to agree",
        "check the calibration",
    ),
    "implausible": Sentence(
        "the [base?base|{mass}] moves by {amplitude:.3g m}, with {speed:.3g m/s}: is a unit wrong (mm taken for m)?"
    ),
    "unit": Sentence(
        "the {mass} moves {gain:.3g} times as far as [by_force?the {force} over the stiffness|the base]: is the unit "
        "of one channel wrong ([angle?degrees or mrad taken for rad|{confused}])?"
    ),
    "base": _BASE,
    "base within noise": _BASE._replace(spares=(*_BASE.spares, "fundamentals")),
    "asymmetric": Sentence(
        "the response is not symmetric: harmonic {order:.0f} is {share:percent} of the fundamental; direct integration "
        "includes the even harmonics, all other results are those of the symmetric part",
        page="asymmetric",
        spares=("direct",),
    ),
    "exchanged": Sentence(
        "the response leads the excitation (sin φ₁ = {sine:.4f}), so that the base takes work out: check the sign of "
        "each channel, and whether two are exchanged",
        page="exchanged",
    ),
    # --- departures from one oscillator: noun phrases in other sentences ----------------------------
    "delay": Sentence(
        f"a response that [less?leads|lags] the drive by {{size:sized µs}} more than the motion explains{_UNSURE}",
        "give the delay in the mapping, or sample all channels at once",
        page="delay",
    ),
    "corner": Sentence(
        f"an AC coupling of the response, a high-pass filter with a corner of {{size:sized Hz}}{_UNSURE}",
        "couple the response directly (DC), or give the corner in the mapping",
        page="corner",
    ),
    "gain": Sentence(
        "a drive that reads {size:sized %} too [less?little|much], or a response that reads as much too "
        f"[less?much|little]{_UNSURE}",
        "calibrate the drive and the response, or give the gain in the mapping",
        page="gain",
    ),
    "frame": Sentence(
        "a response that is [absolute?absolute|relative to the base] and was taken for [absolute?relative to the "
        "base|absolute]",
        "name the quantity so in the mapping (relative_{displacement}, {displacement}, …)",
        page="frame",
    ),
    "friction_level": Sentence(
        "a friction {force} that changes with the level, by {size:sized %} for e times the level"
        + _UNSURE,
        "give levels a friction {force} each (--groups)",
        page="friction-level",
    ),
    "friction_speed": Sentence(
        "a friction {force} that changes with the speed, and is {size:sized %} larger at rest"
        + _UNSURE,
        "the model has none",
        page="friction-speed",
    ),
    "c_2": Sentence(
        "damping that grows with the speed, by c_2 = {size:sized N s²/m²}" + _UNSURE,
        "compare the laws (--laws)",
        page="c-2",
    ),
    "k_3": Sentence(
        "a spring that is not linear, with k_3 = {size:sized N/m³}" + _UNSURE,
        "the model has none",
        page="k-3",
    ),
    "gradual": Sentence(
        f"a contact that {_GRADUALLY} and not at once, by {{size:sized}} of one of Iwan{_UNSURE}",
        "identify the distribution of its yield {forces} from more levels",
        page="gradual",
    ),
    # --- forced records: the oscillator -------------------------------------------------------------
    "departs": Sentence(
        "the records show {causes}: it explains {fall:.0f} of χ², and the answer is corrected for it[others?; {others} "
        "explains them as well, and the intervals include both]",
        "{causes:remedies}",
    ),
    "hints": Sentence(
        "the records hint at {causes}: it would explain {fall:.0f} of χ², but the energy balance contradicts the "
        "numbers that follow, and is nearer to those of the fit without it, which are the answer; the intervals "
        "include both",
        "{first:remedies}",
    ),
    "far from all": Sentence(
        "the records are not those of one {mass} on a spring, a damper and one friction contact: the closest fit of "
        "{trials:.0f} trials has a residual {times:factor} times the noise, largest in {worst}[likely?; the likeliest "
        "of the causes tested is {likely}, which explains {share:percent} of that]"
    ),
    "no oscillator": Sentence(
        "no oscillator with this stiffness and a friction contact slips and responds like the records: check the "
        "stiffness, the signs, the units and the order of the channels"
    ),
    "far": Sentence("no such oscillator explains the records: this is only the closest fit"),
    "not converged": Sentence(
        "the search for the best fit stopped before it converged: its numbers are not the optimum"
    ),
    "at its limit": Sentence(
        "the best {symbol:symbols} is at its limit, zero: its error is not normally distributed"
    ),
    "fundamentals": Sentence(
        "no one oscillator explains the higher harmonics: the numbers are fitted to the fundamental of each level, "
        "whose dynamic stiffness scatters by {scatter:.2g %} about the fit; the intervals follow from that "
        "scatter[causes?, corrected for {causes}]"
    ),
    "mass": Sentence(
        "the {masses:masses}, more than their uncertainties allow: [fixture?does a fixture above the load cell move "
        "along (--fixture-mass)? Otherwise |[meant?did you mean {meant:readings}? Otherwise ]]check {mass}, stiffness, "
        "gains and units, as an error in one may shift all numbers by as much",
        page="mass",
    ),
    "stuck": Sentence(
        "the records are those of a linear oscillator within their noise: the contact only sticks, and {F_k} and K_z "
        "cannot be determined",
        "raise the excitation",
        page="stuck",
    ),
    "loose": Sentence(
        "the records are those of a linear oscillator within their noise: hardly any friction shows; lower levels show "
        "more of what there is",
        page="stuck",
    ),
    "linear": Sentence(
        "the records are those of a linear oscillator within their noise: the contact only sticks, or there is no "
        "friction, and {F_k} and K_z cannot be determined",
        "raise the excitation",
        page="stuck",
    ),
    "too stiff": Sentence(
        "k is stated at least [too_high?{too_high:larger}|a multiple of itself] too high for the records, as a contact "
        "can only add to it: check stiffness, {mass}, gains and units"
    ),
    "unresolved": Sentence(
        "the records together do not resolve the onset of slip: K_z has a lower limit only",
        "sample faster, measure {acceleration}, or reduce the noise",
        page="unresolved",
    ),
    "only sticks": Sentence(
        "the contact only sticks in record {records}: it takes no energy there, and the balance leaves the record out"
    ),
    "skewed": Sentence(
        "c and c_r together cannot be distinguished from a skew of the channels: if the response lags by 1 µs, c_r is "
        "{by:2 N s/m} too small and c as much too large"
    ),
    "contradicts": Sentence(
        "the energy balance and the fit of one oscillator to all records differ by more than their errors allow: "
        "{changes:changes}"
    ),
    "alike": Sentence(
        "the levels are so alike that {symbols:symbols} can hardly be distinguished by the balance: add a record at a "
        "much higher or lower amplitude",
        page="alike",
    ),
    "mount": Sentence(
        "a mount, whose friction acts between base and {mass}, explains the records within their noise "
        "({values:values}): if yours is one, give contact_to=base (--contact-to base)"
    ),
    # --- forced records: the balance ----------------------------------------------------------------
    "negative": Sentence(
        "{value:values} is negative, which physics forbids: [clipped?clipping is the likely cause ({clipped})|a sign, "
        "a gain, a channel or the stiffness may be wrong]",
        "[clipped?raise the measuring range]",
    ),
    "no friction column": Sentence(
        "the records show neither {F_k} nor K_z: c is taken from W = b c"
    ),
    "hardly any friction": Sentence(
        "the records show hardly any friction, and no K_z: {limits:limits} at 95 %[unsure? if the contact slips; that "
        "it only sticks, whatever {F_k} is, they do not exclude: give the {mass} (--{mass}), or add records at another "
        "frequency]"
    ),
    "onset of the closest": Sentence(
        "slip onset could not be detected: the stick distance is taken from the closest fit"
    ),
    "onset of a rigid one": Sentence(
        "slip onset could not be detected: the contact is taken as rigid, and {F_k} is too small"
    ),
    "rows scatter": Sentence("the residual of its rows is {times:factor} times the noise"),
    "rows uncorrected": Sentence(
        "its rows are not corrected for the departure that the records show (see below)"
    ),
    "fewer levels": Sentence(
        "there are fewer levels than coefficients: only the shape of the waveforms distinguishes them, and no balance "
        "checks it",
        "add records at other amplitudes",
    ),
    "level for each": Sentence(
        "a balance needs a level for each coefficient: add records at other amplitudes"
    ),
    "few rows": Sentence(
        "{symbols:symbols} need at least {needed:.0f} usable responses, got {usable:.0f} of {all:.0f}: the others lack "
        "a feature (nothing slips)",
        "raise their excitation or add levels",
    ),
    "rows alike": Sentence(
        "the {usable:.0f} usable responses are one and the same, or nothing slides in any of them: {symbols:symbols} "
        "cannot be distinguished",
        "use levels that differ and slip",
    ),
    # --- free decays --------------------------------------------------------------------------------
    "no decay": Sentence(
        "the motion about {time:.4g s} is no free decay that slips, and is left out"
    ),
    "other decay": Sentence(
        "the motion from {start:.4g s} to {end:.4g s} is no free decay of this oscillator, and is left out"
    ),
    "half cycles differ": Sentence(
        "the half cycles do not share one {F_k} and c: χ² is {misfit:.3g} per row"
    ),
    "few half cycles": Sentence(
        "the samples show too few half cycles clearly, {halves:.0f}, to distinguish {F_k} from c",
        "start the decay higher, sample faster, or give more decays",
    ),
    "decays without friction": Sentence(
        "the decays show no friction in addition to the damping: if the contact sticks all the time, c belongs to the "
        "stiffness k + K_z, and is 1 + K_z/k times as large"
    ),
    "rings": Sentence(
        "on the contact the {mass} rings at {hertz:.3g Hz}, more than half of the {rate:.3g} samples a second: other "
        "values of K_z may explain the samples as well",
        "sample faster",
    ),
    "negative decay": Sentence(
        "{value:values} is negative, which physics forbids: [clipped?clipping is the likely cause ({clipped})|the "
        "drive, a hand on the {mass}, a gain or a filter may be wrong]",
        "[clipped?raise the measuring range]",
    ),
    "other law": Sentence(
        "friction and viscous damping do not account for the decays: {what} explains them ({value:measured}), and "
        "friction that varies in another way may, too, with other values",
        "compare the laws (--laws, laws=True) before using {F_k} and c",
    ),
    "falls along": Sentence(
        "the fit includes friction that falls with the speed: {F_k} is the {force} at high speed, to which it falls by "
        "{by:± N} over {speed:2 m/s}; a {mass} at rest breaks loose at {loose:3 N}"
    ),
    "corner along": Sentence(
        "the fit includes an AC coupling of the channel with a corner of {size:± Hz}", page="corner"
    ),
    "spring along": Sentence(
        "the fit includes a spring that stiffens or softens with its deflection ({value:measured})",
        page="k-3",
    ),
    "unexplained decays": Sentence(
        "friction and viscous damping do not account for the decays ({p:p-value}): [falls?a friction that falls with "
        "the speed, or damping that grows less with it than viscous damping does,|{what}] would explain most of it "
        "({value:measured}); {F_k} and c may include its effect"
    ),
    "no one decays": Sentence(
        "the decays are not those of one {mass} on a spring, a damper and one friction contact: the residual of the "
        "closest fit is {share:percent} of the motion in the band of the mode"
    ),
    "friction differs": Sentence(
        "The decays do not share one friction {force}: {forces:± N}. {F_k} is their mean, and its interval includes "
        "their scatter, a standard deviation of {scatter:.2g N} or {share:.2g %}."
    ),
    "hints of another law": Sentence(
        "The values are those of friction and viscous damping. The decays hint at quadratic damping, which would "
        "change {changes:up to}; friction that falls with the speed looks alike and changes them the other way. The "
        "intervals include both: give decays from higher up, or with less noise, if the damping may not be viscous."
    ),
    # --- what a fit implies about the rig -----------------------------------------------------------
    "best fit": Sentence(
        "Best fit: [given?your {mass}|{m} = {size:± kg}], natural frequency {hertz:4 Hz} with the contact slipping. If "
        "your rig differs, check gains, units and stiffness."
    ),
    "masses": Sentence("The {masses:masses}."),
    "timing": Sentence("Timing check: the response is {late:± µs} late (no delay detected)."),
    "contact taken as sudden": Sentence(
        "K_z and its interval are conditional on a contact that yields at once, which these records cannot test: one "
        f"that {_GRADUALLY} moves alike, and is stiffer by up to {{by:larger}} right after a reversal. To use K_z for "
        "that stiffness, test it with less noise, or with levels at which the contact hardly slips."
    ),
    "k by the mass": Sentence(
        "k = {k:± N/m} follows from the {mass} and the natural frequency of the records, and all numbers are in "
        f"proportion to it. {_STATICALLY}"
    ),
    "conditional": Sentence(
        "All numbers are conditional on the [k?stiffness and the ]gains, which the records alone hardly test, or not "
        'at all[state?: state their uncertainties (--stiffness "{k:g} ± 1 %")[weigh? and give the {mass} (--{mass}), '
        "which tests them]|[weigh?: give the {mass} (--{mass}), which tests them]]."
    ),
    "depends": Sentence("An error of {effects:effects}."),
    # --- why records give no numbers ----------------------------------------------------------------
    "no stiffness": Sentence(
        f"stiffness (--stiffness) is missing: {{kind}} need it, {{N/m}}. {_STATICALLY} Where that cannot be done, the "
        "mass alone (--mass) gives it from the frequency of the motion. Only a table of a stepped sine with a force "
        "does without (kind stepped-sine)"
    ),
    "no stiffness of a force": Sentence(
        "a {force} drives; stiffness is missing, and a {mass} alone gives none then. " + _STATICALLY
    ),
    "no natural frequency": Sentence(
        "the records do not show the natural frequency from which, with the {mass}, the stiffness follows: give it "
        f"(--stiffness). {_STATICALLY}"
    ),
    "no base": Sentence(
        "a {force} drives; contact_to = base is for a base that moves: leave it out, as ground and base are at rest "
        "alike"
    ),
    "no load cell": Sentence(
        "fixture_mass is what a load cell carries besides the {mass}, and the record has no {force}: leave it out"
    ),
    "impossible": Sentence(
        "with k = {k:g N/m} and {m} = {given:g kg} the oscillator swings {swings:.2g} times in a cycle: give the "
        "{mass} in {kg} and the stiffness in {N/m}, or leave out the {mass}"
    ),
    "no decay found": Sentence(
        "[channel?{channel} stands still|the excitation channel is missing ({drives})], and no free decay was found: "
        "[why?{why}|the motion is not that of a {mass} on a spring of {k:g N/m} with friction; give the record from "
        "the release or the blow on]"
    ),
    "no friction contact": Sentence(
        "the motion is no free decay of a {mass} on a spring of {k:g N/m} with a friction contact: the closest fit has "
        "{halves:.0f} half cycles that slip and a residual of {share:percent} of the motion; is the {mass} driven, or "
        "is its frequency or its gain not constant? Give the record from the release or the blow on"
    ),
    "not forced": Sentence(
        "the excitation channel is missing or constant, or only strikes: a forced record needs one that keeps moving "
        "({drives}); a free decay is identified by itself (--kind ring-down)"
    ),
    # --- a stepped sine -----------------------------------------------------------------------------
    "two levels": Sentence(
        "two levels do not show whether one slider is enough, or many slip one after the other: add a level"
    ),
    "stiffness differs": Sentence(
        "the stiffness stated is {k:g} N/m, but the lines imply {shown:± N/m}: a unit or a gain may be wrong[soft?, a "
        "part of the contact may stick in every line]",
        "leave it out to identify it",
    ),
    "sticks in every line": Sentence(
        "the stiffness stated is {k:g} N/m, but the lines imply {shown:6 N/m}: a contact of {stuck:4 N/m} sticks in "
        "every line, or the stiffness stated is too small; F_k, K_z and c are the same in both cases"
    ),
    "another contact": Sentence("the lines support another contact: {contact}"),
    "no contact": Sentence("these lines show no contact that slips[why?: {why}]"),
    "contact": Sentence(
        "the lines support {contact} with {terms:symbols} (loss {loss:percent}, in-phase {stiffness:3 N/m} rms)"
        "[tested?; one slider is [enough?enough|not enough] (p = {p:.2g})]"
        "[others?; held-out levels do not distinguish it from {others:or}: add levels][stiffer?; {stiffer}]"
    ),
    "other contact": Sentence(
        "{contact} has the same loss ({loss:percent}), and the in-phase rows distinguish them ({stiffness:3 N/m})"
    ),
    "part that slips": Sentence(
        "F_k and K_z are those of the part of the contact that slips at the amplitudes seen, up to {X:.4g mm}."
    ),
    "oscillator of lines": Sentence(
        "The oscillator has m = {m:± kg}, k = {k:± N/m} and a natural frequency of {hertz:4 Hz} with that part of the "
        "contact loose."
    ),
    "hardens": Sentence("Its stiffness rises with the amplitude by ¾ k_3 X², k_3 = {k_3:± N/mm³}."),
    "other modes": Sentence(
        "Other modes of the structure move the driven point by R = {R:.3g µm/N}, [mass?as the inertia of {mass:.2g kg} "
        "does|of their flexibility]."
    ),
    "phases": Sentence("The lines of {tables} show that {way}."),
    # --- loops --------------------------------------------------------------------------------------
    "one slider predicts": Sentence(
        "One slider predicts held-out cycles at least as well as many do."
    ),
    "many sliders predict": Sentence(
        "Many sliders, a contact that yields gradually, predict held-out cycles better than one does."
    ),
    "taken for loops": Sentence(
        "The records are taken for loops of a contact, as neither stiffness nor mass is given; if the force drives a "
        "mass on a spring, give its stiffness (--stiffness): they are forced records then."
    ),
    "friction coefficient": Sentence("μ = F_k/N = {mu:±} at 95 %."),
    "loops stick": Sentence(
        "the contact does not slip in these loops: raise the amplitude to determine F_k and K_z"
    ),
    "one speed": Sentence(
        "the speed is the same in all of the motion: c is not determined, and F_k includes c times this speed"
    ),
    "c hidden": Sentence(
        "c cannot be distinguished from a contact that yields gradually: vary the speed"
    ),
    "flipped": Sentence(
        "the sign of the force of {records} is reversed, as with the recorded one energy would be gained"
    ),
    "falls": Sentence(
        "the friction at rest is {by:percent} of F_k [larger?larger|smaller] than at speed: F_k holds for one speed "
        "only, and c is no damper"
    ),
    "negative damping": Sentence(
        "the fit has a negative damping, c = {c:± N s/m}: no contact with a damper has loops of this shape"
    ),
    "other shape": Sentence(
        "the contact leaves a residual of {share:percent} of F_k, rms: no slider with spring and damper has loops of "
        "this shape",
        "look at them in the report",
    ),
    "excerpt": Sentence(
        "The contact is fitted to {fitted:.0f} of the {all:.0f} cycles, in {runs:.0f} runs spread evenly; the history "
        "is of all."
    ),
    "friction of each": Sentence(
        "The friction force differs from record to record, {forces:each N}: F_k is [N?that at N = {N:4 N}|their mean]."
    ),
    "parallel spring": Sentence("A spring of k = {k:± N/m} acts in parallel to the contact."),
    "rounded knee": Sentence(
        "The knee of the loop is rounded, as in the contact of Bouc and Wen with n = {n:±}."
    ),
    "friction falls": Sentence(
        "The friction falls with the speed: at rest it is larger by F_S = {F_S:± N}, which falls off over v_S = "
        "{v_S:± m/s}; F_k is that at high speed."
    ),
    "quadratic damper": Sentence(
        "A quadratic damper of c_2 = {c_2:± N s²/m²} acts in addition to the viscous one."
    ),
    "mass between": Sentence("A mass of m = {m:± kg} moves between contact and load cell."),
    "backlash": Sentence(
        "The fixture has a backlash: a dead band of {gap:± mm} in the displacement."
    ),
    "loss of a loop": Sentence(
        "{record}: a cycle of X = {X:4 mm} loses {lost:4 J}, as a viscous damper of {c:4 N s/m} would."
    ),
    "steady loss": Sentence(
        "{record}: the loss per cycle is steady from cycle {cycle:.0f} on[trend?, with a trend of {trend:± %} per "
        "cycle over all cycles]."
    ),
    # --- verdicts -----------------------------------------------------------------------------------
    "upper limit": Sentence("an upper limit only: {limits:limits}"),
    "lower limit": Sentence("a lower limit only: {limits:limits}"),
    "wide": Sentence("its interval is wider than its value"),
    "undetermined": Sentence("these records do not determine {symbol:symbols}"),
}
"""Code → what the finding says. One more is one entry here."""
