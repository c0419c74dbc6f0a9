"""Physical effects a rigid body lacks: one law a function, a table of its parameters, one registry."""

from jaxswarm.effects import base_compliance as base_compliance
from jaxswarm.effects import bodies as bodies
from jaxswarm.effects import cable_coupling as cable_coupling
from jaxswarm.effects import contact as contact
from jaxswarm.effects import cubic_spring as cubic_spring
from jaxswarm.effects import dead_zone_spring as dead_zone_spring
from jaxswarm.effects import drive_lag as drive_lag
from jaxswarm.effects import dwell_friction as dwell_friction
from jaxswarm.effects import encoder_eccentricity as encoder_eccentricity
from jaxswarm.effects import encoder_offset as encoder_offset
from jaxswarm.effects import friction as friction
from jaxswarm.effects import friction_change as friction_change
from jaxswarm.effects import gear_coupling_error as gear_coupling_error
from jaxswarm.effects import gravity_compensator as gravity_compensator
from jaxswarm.effects import hardening_elasticity as hardening_elasticity
from jaxswarm.effects import lagging_temperature as lagging_temperature
from jaxswarm.effects import link_geometry as link_geometry
from jaxswarm.effects import lugre_friction as lugre_friction
from jaxswarm.effects import maxwell_slip as maxwell_slip
from jaxswarm.effects import measurement as measurement
from jaxswarm.effects import motor as motor
from jaxswarm.effects import offset_change as offset_change
from jaxswarm.effects import offset_drift as offset_drift
from jaxswarm.effects import payload_change as payload_change
from jaxswarm.effects import periodic_force as periodic_force
from jaxswarm.effects import position_friction as position_friction
from jaxswarm.effects import relaxing_spring as relaxing_spring
from jaxswarm.effects import torque_constant_saturation as torque_constant_saturation
from jaxswarm.effects import torque_crosstalk as torque_crosstalk
from jaxswarm.effects import torque_dead_band as torque_dead_band
from jaxswarm.effects import torque_lag as torque_lag
from jaxswarm.effects import transmission as transmission
from jaxswarm.effects.base import REGISTRY as REGISTRY
from jaxswarm.effects.base import Effect as Effect
from jaxswarm.effects.base import Export as Export
from jaxswarm.effects.base import get_law as get_law
from jaxswarm.effects.base import register as register
from jaxswarm.effects.formula_file import register_from as register_from
from jaxswarm.effects.kinds import BodyChange as BodyChange
from jaxswarm.effects.kinds import ExternalTorque as ExternalTorque
from jaxswarm.effects.kinds import MeasurementLaw as MeasurementLaw
from jaxswarm.effects.kinds import TorqueLaw as TorqueLaw
from jaxswarm.effects.kinds import TransmissionLaw as TransmissionLaw
from jaxswarm.effects.parameter import Parameter as Parameter
from jaxswarm.effects.sample import Sample as Sample
from jaxswarm.effects.sample import make_sample as make_sample

# The kind most new effects are.
Law = TorqueLaw
