"""Linear and steep waves: dispersion, spectra, field equations."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.sea.current import Current
from jackettwin.loads.sea.waves import AirySea, airy_wave, irregular_sea, jonswap, peak_factor, wave_number

G = 9.80665


@pytest.mark.parametrize("depth", [5.0, 50.0, 4000.0])
def test_dispersion(depth: float) -> None:
    omega = np.geomspace(0.02, 8.0, 60)
    k = wave_number(omega, depth)
    np.testing.assert_allclose(G * k * np.tanh(k * depth), omega**2, rtol=1e-12)


@pytest.mark.parametrize("gamma", [1.0, 2.0, 3.3, 5.0])
def test_jonswap_holds_its_significant_height_and_peak(gamma: float) -> None:
    f = np.linspace(1e-4, 3.0, 300_000)
    S = jonswap(f, Hs=6.0, Tp=10.0, gamma=gamma)
    assert 4.0 * np.sqrt(np.trapezoid(S, f)) == pytest.approx(6.0, rel=0.01)  # the bar; 0.287 ln γ is a fit
    assert f[np.argmax(S)] == pytest.approx(0.1, rel=2e-3)


def test_pierson_moskowitz_in_closed_form() -> None:
    """γ = 1: S(fp) = 0.3125 Hs² Tp e^{−1.25}."""
    S = jonswap(np.array([0.1]), Hs=6.0, Tp=10.0, gamma=1.0)
    assert float(S[0]) == pytest.approx(0.3125 * 36.0 * 10.0 * np.exp(-1.25), rel=1e-12)


def test_peak_factor_of_the_standard() -> None:
    assert [peak_factor(9.0, 3.6 * 3), peak_factor(9.0, 15.0)] == [5.0, 1.0]
    assert peak_factor(9.0, 13.0) == pytest.approx(np.exp(5.75 - 1.15 * 13.0 / 3.0))


def test_random_seas_have_the_variance_and_spectrum_asked_for() -> None:
    """Sampling error: 12 records of 1800 s at Tp 8 s."""
    t = np.arange(0.0, 1800.0, 0.9)  # Nyquist 0.56 Hz, above the cut-off 0.5 Hz
    origin = np.zeros((1, 3))
    periodogram = 0.0
    variances = []
    for seed in range(12):
        sea = irregular_sea(Hs=4.0, Tp=8.0, depth=70.0, duration=1800.0, seed=seed, gamma=3.3)
        eta = sea.elevation(origin, t)[:, 0]
        variances.append(eta.var())
        periodogram = periodogram + np.abs(np.fft.rfft(eta)) ** 2 * 2.0 * 0.9 / t.size / 12.0
    standard_error = np.std(variances) / np.sqrt(12) / np.mean(variances)
    assert abs(np.mean(variances) - 1.0) < 3.5 * standard_error + 0.01
    f = np.fft.rfftfreq(t.size, 0.9)
    band = np.abs(f - 0.125) < 0.02
    expected = jonswap(f[band], Hs=4.0, Tp=8.0, gamma=3.3).mean()
    # a periodogram's CoV is 1: 12 records × 72 lines give 3.4 %
    assert periodogram[band].mean() == pytest.approx(expected, rel=4 * 0.034)


def test_seeds_repeat_and_differ() -> None:
    def phases(seed: int) -> np.ndarray:
        return irregular_sea(Hs=3.0, Tp=7.0, depth=70.0, duration=600.0, seed=seed).phase

    np.testing.assert_array_equal(phases(5), phases(5))
    assert (phases(5) != phases(6)).all()


def test_spread_headings_follow_cosine_2s() -> None:
    """⟨cos β⟩ = s/(s+1) for cos^{2s}(β/2)."""
    sea = irregular_sea(Hs=3.0, Tp=7.0, depth=70.0, duration=36000.0, seed=1, spreading=8.0, direction=0.5)
    mean = np.cos(sea.direction - 0.5).mean()
    error = np.cos(sea.direction - 0.5).std() / np.sqrt(sea.direction.size)
    assert abs(mean - 8.0 / 9.0) < 4.0 * error


def sea_without_stretching() -> AirySea:
    sea = irregular_sea(Hs=5.0, Tp=9.0, depth=60.0, duration=300.0, seed=2, spreading=4.0)
    return AirySea(sea.amplitude, sea.omega, sea.direction, sea.phase, sea.depth, "none")


def test_the_linear_field_is_irrotational_and_incompressible() -> None:
    """Potential flow ⇔ Laplace: div u = 0 and curl u = 0, by central differences."""
    sea, h = sea_without_stretching(), 0.01
    centre = np.array([[3.0, -4.0, -7.0], [10.0, 0.0, -30.0]])
    gradient = np.empty((2, 3, 3))
    for j in range(3):
        step = h * np.eye(3)[j]
        gradient[:, :, j] = (sea.motion(centre + step, 12.3)[0] - sea.motion(centre - step, 12.3)[0])[0] / (
            2 * h
        )
    scale = np.abs(gradient).max()
    np.testing.assert_allclose(np.trace(gradient, axis1=1, axis2=2), 0.0, atol=1e-4 * scale)  # h² of the step
    np.testing.assert_allclose(gradient, gradient.transpose(0, 2, 1), atol=1e-4 * scale)


def test_free_surface_bed_and_acceleration() -> None:
    """Linear conditions: w = ∂η/∂t and ∂u/∂t = −g ∂η/∂x at z = 0; w = 0 at the bed; a = ∂u/∂t."""
    sea, h, t = sea_without_stretching(), 1e-4, 5.0
    p = np.array([[2.0, 1.0, 0.0]])
    u, a = (field[0, 0] for field in sea.motion(p, t))
    eta_t = (sea.elevation(p, [t + h]) - sea.elevation(p, [t - h]))[0, 0] / (2 * h)
    assert u[2] == pytest.approx(eta_t, rel=1e-6)
    for j in range(2):
        step = h * np.eye(3)[j]
        eta_x = (sea.elevation(p + step, [t]) - sea.elevation(p - step, [t]))[0, 0] / (2 * h)
        assert a[j] == pytest.approx(-G * eta_x, rel=1e-6)
    rate = (sea.motion(p, t + h)[0] - sea.motion(p, t - h)[0])[0, 0] / (2 * h)
    np.testing.assert_allclose(a, rate, rtol=1e-6)
    bed = sea.motion(np.array([[2.0, 1.0, -60.0]]), t)[0][0, 0]
    assert abs(bed[2]) < 1e-12


def test_wheeler_brings_the_surface_value_to_the_surface() -> None:
    wave = airy_wave(height=6.0, period=10.0, depth=50.0)
    stretched = airy_wave(height=6.0, period=10.0, depth=50.0, stretching="wheeler")
    crest, still = np.array([[0.0, 0.0, 3.0]]), np.array([[0.0, 0.0, 0.0]])
    np.testing.assert_allclose(stretched.motion(crest, 0.0)[0], wave.motion(still, 0.0)[0], rtol=1e-12)
    assert float(stretched.surface(crest, np.zeros(1))[0, 0]) == pytest.approx(3.0)
    assert float(wave.surface(crest, np.zeros(1))[0, 0]) == 0.0


@pytest.mark.parametrize(("stretching", "slope"), [("vertical", 0.0), ("extrapolated", 1.0)])
def test_above_still_water_motion_stays_or_runs_straight_on(stretching: str, slope: float) -> None:
    """u(z) = u(0) + z u′(0) with u′(0) = k tanh kd · u(0); w′(0) = k coth kd · w(0); pressure as u."""
    wave = airy_wave(height=6.0, period=10.0, depth=30.0, stretching=stretching)
    k, t = float(wave.k[0]), 1.3
    above, still = np.array([[2.0, 0.0, 2.5]]), np.array([[2.0, 0.0, 0.0]])
    grows = 1.0 + slope * 2.5 * k * np.array([np.tanh(30.0 * k), 1.0, 1.0 / np.tanh(30.0 * k)])
    for high, low in zip(wave.motion(above, t), wave.motion(still, t), strict=True):
        np.testing.assert_allclose(high, low * grows, rtol=1e-12)
    np.testing.assert_allclose(
        wave.pressure(above, np.array([t])), wave.pressure(still, np.array([t])) * grows[0], rtol=1e-12
    )
    assert float(wave.surface(np.zeros((1, 3)), np.zeros(1))[0, 0]) == pytest.approx(3.0)
    below = np.array([[2.0, 0.0, -4.0]])
    linear = airy_wave(height=6.0, period=10.0, depth=30.0)
    np.testing.assert_array_equal(wave.motion(below, t)[0], linear.motion(below, t)[0])


def test_bad_seas_are_refused() -> None:
    with pytest.raises(InputError, match="gamma"):
        irregular_sea(Hs=3.0, Tp=7.0, depth=70.0, duration=600.0, seed=1, gamma=0.5)
    with pytest.raises(InputError, match="none, vertical, extrapolated, wheeler"):
        airy_wave(height=3.0, period=7.0, depth=70.0, stretching="delta")


def test_current_profile() -> None:
    current = Current(depth=70.0, subsurface_m_s=0.8, wind_driven_m_s=0.2, direction=np.pi / 2)
    u = current.velocity(np.array([0.0, -10.0, -70.0]))
    np.testing.assert_allclose(u[:, 1], [1.0, 0.8 * (6 / 7) ** (1 / 7) + 0.1, 0.0], atol=1e-12)
    everywhere = Current(depth=70.0, uniform_m_s=0.4).velocity(np.array([3.0, -69.0]))
    np.testing.assert_array_equal(everywhere, [[0.4, 0.0, 0.0]] * 2)
