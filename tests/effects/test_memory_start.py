"""A memory starts where its law says: at the begin of every log, and of a simulation."""

import jax.numpy as jnp
import numpy as np
from scipy.signal import lsim

from jaxswarm.effects import get_law, make_sample
from jaxswarm.effects.series import states
from jaxswarm.robot import rx60
from jaxswarm.simulate import Acting, make_plant, rest

LAG = get_law("lagging_temperature_friction")


def test_a_lubricant_starts_as_warm_as_its_sensor_in_every_log():
    t = np.linspace(0.0, 20.0, 401)
    heat = 20.0 + 10.0 * np.sin(0.4 * t)
    _, late, _ = lsim(([1.0], [5.0, 1.0]), heat - heat[0], t)
    both = make_sample(t=np.tile(t, 2), temperature=np.concatenate([heat, heat + 7.0]))
    found = states(LAG, {"tl": 5.0}, both)
    np.testing.assert_allclose(found[:401], late + heat[0], atol=2e-3)
    np.testing.assert_allclose(found[401:], late + heat[0] + 7.0, atol=2e-3)


def test_a_simulation_starts_with_the_warmth_that_is_told():
    plant = make_plant(rx60(), [Acting("hysteresis", 0), Acting(LAG.name, 1)])
    assert rest(plant, jnp.zeros(3)).memory.tolist() == [0.0, 25.0]
    warm = rest(plant, jnp.zeros(3), temperature=jnp.array([20.0, 40.0, 30.0]))
    assert warm.memory.tolist() == [0.0, 40.0]
