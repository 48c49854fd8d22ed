"""Faults to plant: one line of a room, what it becomes, and the tests that ought to fail then."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """A fault to plant.

    Attributes
    ----------
    room : package, or module without its ending, below ``jackettwin``
    what : the fault in words
    text, becomes : what stands once in the room, and what it is made
    tests : files or folders of tests of the room
    survives : why no test can or need fail on it, where that is known
    """

    room: str
    what: str
    text: str
    becomes: str
    tests: tuple[str, ...]
    survives: str = ""


def _of(room: str, *tests: str, rows: tuple[tuple[str, str, str], ...]) -> tuple[Fault, ...]:
    return tuple(
        Fault(room, what, text, becomes, tests or (f"tests/{room}",)) for what, text, becomes in rows
    )


FAULTS = (
    *_of("identification/subspace/joined_setups", "tests/identification/test_preger.py", rows=(
        ("moved channels re-scale with the wrong sign", "h[:, c, ~here] = np.tensordot(", "h[:, c, ~here] = -np.tensordot("),
        ("moved channels keep the excitation of their own setup", "np.tensordot(observability, factors[:, ~here], axes=1)", "h[:, c, here][:, :1]"),
    )),
    *_of("identification/preger", "tests/identification/test_preger.py", rows=(
        ("setups keep their own level", "y=one.y * in_units[:, None]", "y=one.y"),
    )),
    *_of("loads/operation", "tests/loads/test_dynamic_inflow.py", "tests/loads/test_bem.py", rows=(
        ("a blade that moves downwind sees more wind", "seen = -pole * tests", "seen = pole * tests"),
        ("the wake answers at once", "(1.0 + _FAST_SHARE * tau * rate) /", "(1.0 + tau * rate) /"),
        ("a skewed wake is stronger upwind", "out[..., 0] *= 1.0 + change", "out[..., 0] *= 1.0 - change"),
        ("a spinning rotor turns the other way", "accelerations[..., 3:] -= turning", "accelerations[..., 3:] += turning"),
        ("blades bend with the centrifugal tension of their root", "beyond = np.cumsum(pull[::-1])[::-1]", "beyond = np.full_like(pull, pull.sum())"),
    )),
    *_of("simulate", "tests/simulate/test_recovery.py", rows=(
        ("a moved interface throws what is inside the other way", "states - motion.values @ M_ib.T", "states + motion.values @ M_ib.T"),
        ("waves that the coordinates follow count twice", "held_displacement(system, along.on_dofs) - followed", "held_displacement(system, along.on_dofs)"),
    )),
    *_of("checks", "tests/checks/test_grouted_joints.py", rows=(
        ("grout slides with another power of its stiffness", "self.radial_stiffness**0.6", "self.radial_stiffness**0.5"),
    )),
    *_of("twin", "tests/twin/test_record_damage.py", rows=(
        ("a rotor at work softens its tower", "self.assembly.stiffness + one.stiffness", "self.assembly.stiffness - one.stiffness"),
    )),
    *_of("structure", rows=(
        ("bending stiffness has a wrong coefficient", "[(4.0 + Phi) * L**2, -6.0 * L, (2.0 - Phi) * L**2]", "[(4.0 + Phi) * L**2, -6.0 * L, (2.0 + Phi) * L**2]"),
        ("consistent mass is 1/3 off along the axis", "pair = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0", "pair = np.array([[2.0, 1.0], [1.0, 2.0]]) / 8.0"),
        ("geometric stiffness has the other sign", "(N / (30.0 * L))[:, None, None]", "(-N / (30.0 * L))[:, None, None]"),
        ("inner diameter takes one wall", "d = D - 2.0 * t", "d = D - t"),
        ("Rayleigh's mass and stiffness parts are swapped", "cls(alpha=damping_ratio * omega, beta=damping_ratio / omega)", "cls(alpha=damping_ratio / omega, beta=damping_ratio * omega)"),
        ("Rayleigh damping without one half", "return 0.5 * (self.alpha / omega + self.beta * omega)", "return (self.alpha / omega + self.beta * omega)"),
        ("an offset mass couples with the wrong sign", "M[:3, 3:] = -m * S", "M[:3, 3:] = m * S"),
        ("bending stress uses half the section modulus", "p.I[:, None] / R, p.J[:, None]", "2.0 * p.I[:, None] / R, p.J[:, None]"),
        ("shear stress is not multiplied by three", "np.sqrt(sigma**2 + 3.0 * tau**2)", "np.sqrt(sigma**2 + tau**2)"),
    )),
    *_of("checks", rows=(
        ("the buckling curve starts elsewhere", "1.0 - 0.278 * lam**2, 0.9 /", "1.0 - 0.278 * lam, 0.9 /"),
        ("the radius of gyration is that of a solid bar", "r = 0.25 * np.sqrt(D**2 + d**2)", "r = 0.25 * np.sqrt(D**2 - d**2)"),
        ("Euler's stress without square", "f_e = np.pi**2 * E", "f_e = np.pi * E"),
        ("bending of tubes: another slope", "[1.0, 1.13 - 2.58 * x]", "[1.0, 1.13 - 1.58 * x]"),
        ("Q_beta has a wrong factor", "beta * (1.0 - 0.833 * beta)", "beta * (1.0 - 0.933 * beta)"),
        ("out-of-plane strength has half the exponent", "3.2 * gamma ** (0.5 * beta**2)", "3.2 * gamma ** (beta**2)"),
    )),
    *_of("fatigue", rows=(
        ("anodes protect above the water", "\"cathodic\" if z_m < low", "\"cathodic\" if z_m > low"),
        ("the second slope begins at ten times the range", "many = S < 1e-6 * self.knee_pa", "many = S < 1e-5 * self.knee_pa"),
        ("bending about z stresses the other side of a tube", "-np.cos(angle) / modulus", "np.cos(angle) / modulus"),
        ("thicker walls leave more of a butt weld's eccentricity", "+ float((T_m / t_m) **", "+ float((t_m / T_m) **"),
        ("thick plates are stronger", "** self.thickness_exponent", "** -self.thickness_exponent"),
        ("the middle brace of a KT joint is shielded as its neighbours", "(shapes[j].beta / own.beta) ** 2 if middle else 1.0", "1.0"),
        ("half cycles count whole", "np.full(self.half.size, 0.5)", "np.full(self.half.size, 1.0)"),
        ("the last closed cycles are taken twice", "self._taken = first.size", "self._taken = max(first.size - 1, 0)"),
        ("saddles and crowns are exchanged", "np.stack([cosine**2, sine**2])", "np.stack([sine**2, cosine**2])"),
        ("a short chord is stiffened at its crown", "F * saddle, crown, F * brace_saddle, brace_crown, *_in_plane(s), out, _brace_side(s) * out\n    )\n\n\ndef _k(", "saddle, F * crown, F * brace_saddle, brace_crown, *_in_plane(s), out, _brace_side(s) * out\n    )\n\n\ndef _k("),
        ("the median is that of the design curve", "10.0 ** (-2.0 * self.curve.log_std)", "10.0 ** (-0.0 * self.curve.log_std)"),
    )),
    *_of("sensing", rows=(
        ("drag of a sea runs against its waves", "np.exp(-1j * float(k)", "np.exp(1j * float(k)"),
        ("gravity pulls on a leaning accelerometer the other way", "np.asarray(-GRAVITY_M_S2 * share", "np.asarray(GRAVITY_M_S2 * share"),
        ("a rotor is turned against its heading", "turn @ self.damping @ turn.T", "turn.T @ self.damping @ turn"),
        ("modes damp each other at the frequency of one of them", ".imag / between * S", ".imag / omega[:, None] * S"),
        ("an offset walks ten times the variance", "(2.0 * np.pi * _DRIFT_HZ * h) ** 2", "(2.0 * np.pi * _DRIFT_HZ) ** 2 * h"),
        ("what is smoothed is what is predicted", "(p, p - p @ known @ p))", "(p, p + 0.0 * known))"),
        ("a pair of motions counts twice on the way back", "into = (self.right / _members(self.rates)).T @ G", "into = self.right.T @ G"),
        ("noise of a step is that of its end", "Q = F @ exact[:n, n:]", "Q = exact[:n, n:]"),
        ("a lightly damped mode leaks into slow forces", "taper = tukey(n, _TAPERED)", "taper = tukey(n, 0.0)"),
        ("short waves reach as deep as long ones", "self._waves(multiples * peak)", "self._waves(peak + 0.0 * multiples)"),
        ("drag on members is in phase with their inertia", "dashpot / (1j * w)", "dashpot / w"),
        ("what begins otherwise stays in the predictions only", "(wanted - wanted @ self.P @ self.information)", "(wanted)"),
        ("a working rotor pushes by twice its damping", "thrust = slope * _AVERAGED", "thrust = 2.0 * slope * _AVERAGED"),
        ("what tells nothing stands for a part of the record", "r, _MISFIT**2 * self.power)", "r, 0.0 * self.power)"),
        ("local waves are drawn with twice their power", "0.5 * number * self.density", "number * self.density"),
        ("local waves are the principal ones again", "(patterns[band.patterns :],)", "(patterns[: band.patterns],)"),
        ("levels are scored with half their curvature", "4.0 * forces.sum(axis=0)", "2.0 * forces.sum(axis=0)"),
    )),
    *_of("soil", rows=(
        ("clay above a layer's top is as strong as where it is asked", "(first * h + within)", "(here * h + within)"),
        ("a caisson's side push lifts its base's moment the other way", "K[0, 4] = K[4, 0] = 0.4 * d * K_H", "K[0, 4] = K[4, 0] = -0.4 * d * K_H"),
        ("a conic's curvature counts twice", "a, b = 1.0 - 2.0 * self.n", "a, b = 1.0 - self.n"),
        ("clay's bearing factor is 8", "J * strength_pa * z, 9.0 * strength_pa * D)", "J * strength_pa * z, 8.0 * strength_pa * D)"),
        ("a clay shaft peaks at twice the displacement", "return TabulatedCurve(tuple(D * z for z in TZ_Z), tuple(t * share for share in (*TZ_T, residual)))", "return TabulatedCurve(tuple(2.0 * D * z for z in TZ_Z), tuple(t * share for share in (*TZ_T, residual)))"),
        ("API's alpha has the wrong exponent", "psi ** (-0.5 if psi <= 1.0 else -0.25)", "psi ** (-0.25 if psi <= 1.0 else -0.5)"),
        ("a springpot's derivative lacks alpha", "slope = slope + alpha * k_alpha", "slope = slope + k_alpha"),
        ("Kelvin–Voigt's tau is inverted", "return Prony(k=(k,), tau=(c / k,))", "return Prony(k=(k,), tau=(k / c,))"),
        ("dashpots of a pile's head give what they should take", "Spring(foot, head.dashpots, Prony(c=1.0))", "Spring(foot, -head.dashpots, Prony(c=1.0))"),
        ("radiation: another exponent", "(0.25 * np.pi) ** 0.75 * a0**-0.25", "(0.25 * np.pi) ** 0.75 * a0**0.25"),
    )),
    *_of("loads", rows=(
        ("heave radiates against sway", "+ 1j * across[:, 2:] * vertical", "- 1j * across[:, 2:] * vertical"),
        ("drag without one half", "0.5 * self.density_kg_m3 * self.drag", "self.density_kg_m3 * self.drag"),
        ("waves run the other way", "np.exp(-1j * self.k * along)", "np.exp(1j * self.k * along)"),
        ("the JONSWAP peak is twice as narrow", "gamma ** np.exp(-0.5 * ((f / fp - 1.0) / sigma) ** 2)", "gamma ** np.exp(-2.0 * ((f / fp - 1.0) / sigma) ** 2)"),
        ("Prandtl's tip loss lacks 2/π", "F = F * 2.0 / np.pi * np.arccos(", "F = F * np.arccos("),
        ("lift and drag are swapped in the torque", "(cl * np.sin(phi) - cd * np.cos(phi))", "(cl * np.cos(phi) - cd * np.sin(phi))"),
        ("the coherence's decay is halved", "np.exp(-DECAY * np.hypot(", "np.exp(-0.5 * DECAY * np.hypot("),
        ("fluctuations have half the variance", "sigma = SIGMA_RATIOS[component] * wind.sigma", "sigma = 0.7 * SIGMA_RATIOS[component] * wind.sigma"),
        ("water in a steep wave is pushed by its speed", "u - 0.5 * (u**2 + w**2))", "u + 0.5 * (u**2 + w**2))"),
        ("x and y of a wave's direction are swapped", "np.stack([u * np.cos(self.direction), u * np.sin(self.direction), w], axis=1)", "np.stack([u * np.sin(self.direction), u * np.cos(self.direction), w], axis=1)"),
    )),
    *_of("response", "tests/response", "tests/structure/test_rotor_modes.py", rows=(
        ("forces of the motion are not extrapolated", "guess = 2.0 * g[k] - before", "guess = g[k]"),
        ("damped frequencies are imaginary parts", "return np.abs(self.eigenvalues) / (2.0 * pi)", "return self.eigenvalues.imag / (2.0 * pi)"),
        ("MAC without normalisation of one side", "cross / np.outer(own, np.einsum(\"ij,ij->j\", x.conj(), Mx).real)", "cross / np.outer(own, np.ones(x.shape[1]))"),
        ("a superelement's damping takes mass for stiffness", "damping.alpha * element.M[b, b] + damping.beta * element.K[b, b]", "damping.beta * element.M[b, b] + damping.alpha * element.K[b, b]"),
        ("own damping is added, not taken off", "matrix -= rayleigh.alpha * np.array(element.mass)", "matrix += rayleigh.alpha * np.array(element.mass)"),
        ("the tide's slope per frequency is inverted", "self.slope_hz_m / self.frequency_hz", "self.frequency_hz / self.slope_hz_m"),
        ("an interval of poles is a tenth narrower", "radius = 2.0 * pi * below_hz", "radius = 1.8 * pi * below_hz"),
    )),
    *_of("records", rows=(
        ("yaw turns the other way", "np.cos(yaw), np.sin(yaw)", "np.cos(yaw), -np.sin(yaw)"),
        ("resampling shifts by half a sample", "lead = -(pad * up + half) % down", "lead = -(pad * up + half + 1) % down"),
        ("a lost stretch is given back a window late", "start, stop = max(parting.window - 2, 0) * length", "start, stop = max(parting.window, 0) * length"),
        ("trends are added", "out: FloatArray = x - slope * t", "out: FloatArray = x + slope * t"),
        ("rotor orders are one too low", "RotorOrder(k, k * low, k * high, 0.0) for k in ORDERS", "RotorOrder(k, (k - 1) * low, (k - 1) * high, 0.0) for k in ORDERS"),
        ("turns are radians", "record.sample_rate_hz / (2.0 * np.pi)", "record.sample_rate_hz / np.pi"),
        ("a record's identity ignores its start", "float(record.sample_rate_hz), start, list", "float(record.sample_rate_hz), list"),
        ("a spike's window is not widened by held samples", "(SPIKE_WINDOW - 1) * hold + 1", "(SPIKE_WINDOW - 1) + 1"),
        ("a half amplitude passes for half power", "middle = np.argmax(passed >= 0.5 * passed[:, -1:], axis=1)", "middle = np.argmax(passed >= 0.9 * passed[:, -1:], axis=1)"),
    )),
    *_of("identification", rows=(
        ("scatter between records correlates", "float(within / np.sqrt(variance_f * relative[1]))", "float(np.sqrt(variance_f * relative[1]) / within)"),
        ("deviations of shapes stay in units of the scale", "mode_shape_std=found.shape_std[:, i] * scale", "mode_shape_std=found.shape_std[:, i]"),
        ("deviations of SSI poles are 12 % too large", "return inside, outside + self.on_others @ ((others / near + turned) * weight[n:])", "return 1.12 * inside, 1.12 * (outside + self.on_others @ ((others / near + turned) * weight[n:]))"),
        ("fused modes are weighted by deviations, not variances", "weight = 1.0 / variances", "weight = 1.0 / np.sqrt(variances)"),
        ("the periodogram is twice as large", "own /= sample_rate_hz * np.sqrt(duration * present.mean())", "own /= sample_rate_hz * np.sqrt(0.5 * duration * present.mean())"),
        ("MPC without square", "np.asarray(((s_xx - s_yy) ** 2 + 4.0 * s_xy**2) / (s_xx + s_yy) ** 2)", "np.asarray(((s_xx - s_yy) ** 2 + 2.0 * s_xy**2) / (s_xx + s_yy) ** 2)"),
        ("a decay's damping has the wrong sign", "omega * (-zeta + 1j * np.sqrt(1.0 - zeta**2))", "omega * (zeta + 1j * np.sqrt(1.0 - zeta**2))"),
        ("Student's factor is inverted", "wider = scipy.special.stdtrit(freedom, QUANTILES[-1]) / NORMAL_90", "wider = NORMAL_90 / scipy.special.stdtrit(freedom, QUANTILES[-1])"),
        ("covariances of one lag more", "length = (n_samples - n_lags) // n_blocks", "length = (n_samples - n_lags - 1) // (2 * n_blocks)"),
        ("real poles have the wrong rate", "a = -np.log(p.eigenvalues.real) * rate", "a = -np.log(p.eigenvalues.real) / rate"),
        ("neighbours alike span a dimension each", "u[:, s > _DISTINCT]", "u[:, s > 0.0]"),
        ("orders of a rotor lock at the inverse ratio", "- moving.log_f[rows][:, None] - np.log(ratio)", "- moving.log_f[rows][:, None] + np.log(ratio)"),
        ("bias of low damping is added", "np.exp(p.log_zeta[mode] - bias[:, 1])", "np.exp(p.log_zeta[mode] + bias[:, 1])"),
    )),
    *_of("watching", rows=(
        ("kinds that are not monitored take a share of the promise", "+ np.log(watch.staked)", "- np.log(watch.staked)"),
        ("a doubted value keeps part of its distance", "np.maximum(distance / DOUBTED, 1.0) ** 2", "np.maximum(distance / DOUBTED, 1.0)"),
        ("a value on which a slope rests alone is believed", "(h / (1.0 - h)) ** 2", "(h / h) ** 2"),
        ("an effect is by unit of the regressor, times it", "float(per_scale) / column.scale", "float(per_scale) * column.scale"),
        ("a jump's deviation is its variance", "(chance / len(JUMPS), jump**2)", "(chance / len(JUMPS), jump)"),
        ("a level counts half of what it shares with its reference", "apart = var - 2.0 * self.cov[:, LEVEL, REFERENCE]", "apart = var - self.cov[:, LEVEL, REFERENCE]"),
        ("the threshold of alarms is divided by ten", "np.log(self.arl_years * YEAR_DAYS * self.crossing)", "np.log(self.arl_years * YEAR_DAYS * self.crossing / 10.0)"),
        ("steps exceed the threshold as if a day moved them twice as far", "half = 0.5 * np.maximum(mu, 1e-6)", "half = np.maximum(mu, 1e-6)"),
        ("learning forgets to shrink the covariance", "row[j] -= part * g[j]", "row[j] -= 0.5 * part * g[j]"),
        ("innovations are not divided by their variance", "mean[i] += g[i] * nu / s", "mean[i] += g[i] * nu"),
        ("Bayes factors of steps lack one half", "each[k] = 0.5 * (bent / wide - np.log(wide)) + own[k]", "each[k] = (bent / wide - np.log(wide)) + own[k]"),
        ("what a missing condition does is nothing", "(0.0 if lacking is None else lacking)", "(0.0 if lacking is None else 0.0 * lacking)"),
        ("slow regressors start anew with a baseline", "np.where(slow, last, first)", "np.where(slow, first, first)"),
        ("processes age with the square root of time", "np.exp(-gaps[r] * rates[k])", "np.exp(-np.sqrt(gaps[r] * rates[k]))"),
    )),
    *_of("updating", rows=(
        ("an addition's deviation is in tolerances", "float(s * f.scale)", "float(s)"),
        ("only the last stage's changes are told", "before * value if factor.is_factor else before + value", "value"),
        ("a symmetric pair is turned across the measured direction", "across = np.array([-np.sin(angle), np.cos(angle)])", "across = np.array([np.cos(angle), np.sin(angle)])"),
        ("a shape's noise counts all sensors", "expected = (1.0 - k / n) * float(m.std @ m.std) / square", "expected = float(m.std @ m.std) / square"),
        ("what is unseen moves the ground the other way", "np.asarray(inverse - inverse @ rows.J @ moved), np.asarray(-moved)", "np.asarray(inverse - inverse @ rows.J @ moved), np.asarray(moved)"),
        ("a 90 % interval is one of 68 %", "half = NORMAL_90 * self.std_per_day", "half = self.std_per_day"),
        ("posterior intervals are of 68 %", "np.quantile(self.log_theta, QUANTILES[::2], axis=0)", "np.quantile(self.log_theta, [0.16, 0.84], axis=0)"),
        ("damping predicted with the other sign", "-damped.poles.real / size", "damped.poles.real / size"),
        ("loss factors are storage over loss", "loss = D.imag / D.real", "loss = D.real / D.imag"),
        ("bridge sampling weighs both samples alike", "np.log([independent, at_trial.size])", "np.log([at_trial.size, at_trial.size])"),
        ("the slope's scatter is not squared", "scatter**2 * log_covariance", "scatter * log_covariance"),
        ("χ² has one freedom more", "freedom = residuals.size - fitted", "freedom = residuals.size - fitted + 1"),
        ("weighted draws are not divided by their own density", "log_w = swarm.log_l + swarm.log_p - log_q", "log_w = swarm.log_l + swarm.log_p"),
        ("a kernel's density lacks its root", "- np.log(np.diag(root)).sum()", "+ np.log(np.diag(root)).sum()"),
    )),
    *_of("simulate", rows=(
        ("damping is tuned on half the ratio", "return damping_ratio(found)", "return 2.0 * damping_ratio(found)"),
        ("noise of sensors is a tenth", "instrument.noise * rng.standard_normal(row.size)", "0.1 * instrument.noise * rng.standard_normal(row.size)"),
        ("a gap of a sensor is counted in seconds", "round(rng.exponential(instrument.dropout_s) / step_s)", "round(rng.exponential(instrument.dropout_s))"),
        ("velocities are read from displacements", "C[k, n : 2 * n] = row", "C[k, :n] = row"),
        ("the mean stress of water is left out at rest", "load, along = load + wet.load, along + wet.along", "load, along = load, along + wet.along"),
    )),
    *_of("twin", rows=(
        ("what simplified waves leave is no part of a record's interval", "np.hypot(model, curves.remainder[sides[kept]])", "np.hypot(model, 0.0 * curves.remainder[sides[kept]])"),
        ("points with little damage take the worst point's", "found[minor] = known[minor] * found[int(known.argmax())]", "found[minor] = found[int(known.argmax())]"),
        ("steel's mass lowers no frequency", "found[:, j] -= omega**2", "found[:, j] += omega**2"),
        ("Birge's factor over days counts one day too many", "between / (days - 1)", "between / days"),
        ("Birge's factor over records counts one too many", "records / (n - 1)", "records / n"),
        ("the mean frequency is not weighted", "frequency_hz=exp(s.px / s.p)", "frequency_hz=exp(s.px / s.q)"),
        ("a direction is turned by its full angle", "0.5 * atan2(self.sine, self.cosine)", "atan2(self.sine, self.cosine)"),
        ("scatter widens variances twice", "own_f * sqrt(f.widened), own_z * sqrt(z.widened)", "own_f * f.widened, own_z * z.widened"),
    )),
    *_of("study", rows=(
        ("the model's error replaces the data's", "m.frequency_std_hz or error.frequency * f", "error.frequency * f"),
        ("the model's error of damping replaces the data's", "m.damping_ratio_std or error.damping * zeta", "error.damping * zeta"),
    )),
    *_of("change", rows=(
        ("a change takes back what is like it, not against it", 'way = -1.0 if answer.way == "takes_back"', 'way = 1.0 if answer.way == "takes_back"'),
        ("mixing two modes takes from both of them", "-phi * G[i, j] / before[j]", "phi * G[i, j] / before[j]"),
        ("a monopile's head is kept upright in scour", "log(free[0]), log(free[3])", "log(upright[0]), log(upright[3])"),
        ("a clock put back is read as put forward", "stamps[rows[later]] = again[rows[later]]", "stamps[rows[~later]] = again[rows[~later]]"),
        ("every look corrects the last one", 'now["probability"] < _TURNED * left', 'now["probability"] < 0.0 * left'),
        ("scour stiffens the feet", "(np.exp(-per_m * chosen) for per_m", "(np.exp(per_m * chosen) for per_m"),
        ("a weakened brace keeps its stiffness", "_scaled(members, 0.7)", "_scaled(members, 1.0)"),
    )),
    *_of("answers", rows=(
        ("a prior's interval is one of 68 %", "np.exp(NORMAL_90 * p.log_std)", "np.exp(p.log_std)"),
        ("two runs' deviations are not added", "sqrt(max(s * s + t * t - 2.0 * shared * s * t, 0.0))", "max(s, t)"),
        ("a parameter's deviation is that of half the interval", "return log(self.high / self.low) / (2.0 * NORMAL_90)", "return log(self.high / self.low) / NORMAL_90"),
    )),
    *_of("intervals", "tests/test_intervals.py", rows=(
        ("90 % intervals are of 95 %", "math.exp(min(NORMAL_90 * float(log_std), MOST))", "math.exp(min(NORMAL_95 * float(log_std), MOST))"),
        ("90 % of draws are 80 %", "(0.05, 0.5, 0.95)", "(0.1, 0.5, 0.9)"),
    )),
    *_of("report", rows=(
        ("prefixes are of the next size", "((1e12, \"T\"), (1e9, \"G\"),", "((1e12, \"T\"), (1e9, \"M\"),"),
        ("± is a standard deviation", "half = NORMAL_90 * scale * std", "half = scale * std"),
    )),
    *_of("store", rows=(
        ("a server ends work that is another's", "work.c.state == \"leased\", work.c.owner == owner)", "work.c.state == \"leased\")"),
        ("work is leased twice", "taken = {\"state\": \"leased\"", "taken = {\"state\": \"queued\""),
        ("the last try is not the last", "job.tries + 1 < MOST_TRIES", "job.tries < MOST_TRIES"),
        ("a packed step is rounded down", "np.round(x * (denominator / numerator))", "np.floor(x * (denominator / numerator))"),
        ("a dead server's work counts as tried", "_UNTRIED = {\"state\": \"queued\", \"owner\": None, \"tries\": work.c.tries - 1}", "_UNTRIED = {\"state\": \"queued\", \"owner\": None, \"tries\": work.c.tries}"),
        ("events are told without their lock", "if connection.dialect.name == \"postgresql\":\n        connection.execute(text(\"select pg_advisory_xact_lock(740114)\"))", "if False:\n        pass"),
    )),
    *_of("service", "tests/service/test_packets.py", "tests/service/test_consequences.py", "tests/service/test_watched.py", rows=(
        ("a packet's samples land one late", "at = np.round(times).astype(int)", "at = np.round(times).astype(int) + 1"),
        ("two servers fold an asset's days at once", ".where(tables.assets.c.name == asset).with_for_update())", ".where(tables.assets.c.name == asset))"),
        ("a gap of one sample is bridged", "np.diff(times) > 1.5", "np.diff(times) > 2.5"),
    )),
    *_of("service/alerts", "tests/service/test_alerts.py", rows=(
        ("the signature leaves out the time", "f\"{message_id}.{stamp}.\".encode() + body", "f\"{message_id}.\".encode() + body"),
        ("a rule takes what is below its severity", "SEVERITIES.index(finding[\"severity\"]) >= SEVERITIES.index(self.severity)", "SEVERITIES.index(finding[\"severity\"]) <= SEVERITIES.index(self.severity)"),
        ("a digest is due when its interval begins", "timedelta(seconds=-((_EPOCH - now).total_seconds() // period) * period)", "timedelta(seconds=((now - _EPOCH).total_seconds() // period) * period)"),
        ("quiet hours end a day early", "timedelta(days=1 if over_night and late else 0)", "timedelta(days=0)"),
        ("what was acknowledged is told", "if stands[alert.id].answered or not alerts.still_found(connection, alert)", "if not alerts.still_found(connection, alert)"),
        ("a message is sent once more than is allowed", "if alert.tries + 1 >= MOST_TRIES", "if alert.tries >= MOST_TRIES"),
        ("minutes of an escalation are seconds", "due = now + timedelta(minutes=after)", "due = now + timedelta(seconds=after)"),
    )),
    *_of("updating/search", "tests/updating/test_prony.py", "tests/updating/test_solutions.py", rows=(
        ("a branch that the data need is left out", "return bool((path.problem.costs(points, path.last) <= ceiling).all())", "return True"),
        ("laws with other branches left count as the same", "return _level(self._path, way, ceiling) or all(", "return True or all("),
    )),
    *_of("updating/model_error/error_model", "tests/test_wrong_models.py", rows=(
        ("tolerances are half as large", "common = residuals.gains(", "common = 0.5 * residuals.gains("),
        ("tolerances are twice as large", "common = residuals.gains(", "common = 2.0 * residuals.gains("),
    )),
    *_of("identification/decays", "tests/identification/decays/test_modes_of_decay.py", "tests/identification/decays/test_relaxations.py", rows=(
        ("close pairs of a decay are one mode", "if min(shares, default=1.0) < HALVED else []", "if False else []"),
        ("a relaxation beyond the tested rates is told", "if pole is not None and not rates[0] <= pole.rate_rad_s <= rates[-1]:", "if False:"),
    )),
)  # fmt: skip
