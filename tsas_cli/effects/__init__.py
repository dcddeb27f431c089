"""Everything that makes a real rig differ from the nominal one, one file each."""

from typing import NamedTuple

from tsas_cli.effects.antagonist import ANTAGONIST, Antagonist
from tsas_cli.effects.backlash import BACKLASH, Backlash
from tsas_cli.effects.bend_drift import BEND_DRIFT, BendDrift
from tsas_cli.effects.channel_delay import CHANNEL_DELAY, ChannelDelay
from tsas_cli.effects.direction_dependent_friction import (
    DIRECTION_DEPENDENT_FRICTION,
    DirectionDependentFriction,
)
from tsas_cli.effects.drive_compliance import DRIVE_COMPLIANCE, DriveCompliance
from tsas_cli.effects.drive_damping import DRIVE_DAMPING, DriveDamping
from tsas_cli.effects.drive_friction import DRIVE_FRICTION, DriveFriction
from tsas_cli.effects.drive_inertia import DRIVE_INERTIA, DriveInertia
from tsas_cli.effects.drive_ripple import DRIVE_RIPPLE, PERIOD_MM
from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.effects.force_crosstalk import FORCE_CROSSTALK, ForceCrosstalk
from tsas_cli.effects.force_sensor_curvature import FORCE_SENSOR_CURVATURE, ForceSensorCurvature
from tsas_cli.effects.force_sensor_drift import FORCE_SENSOR_DRIFT, ForceSensorDrift
from tsas_cli.effects.force_sensor_gain import FORCE_SENSOR_GAIN, ForceSensorGain
from tsas_cli.effects.force_sensor_gain_drift import (
    FORCE_SENSOR_GAIN_DRIFT,
    ForceSensorGainDrift,
)
from tsas_cli.effects.force_sensor_hysteresis import FORCE_SENSOR_HYSTERESIS, ForceSensorHysteresis
from tsas_cli.effects.force_sensor_offset import FORCE_SENSOR_OFFSET, ForceSensorOffset
from tsas_cli.effects.force_sensor_tilt import FORCE_SENSOR_TILT, ForceSensorTilt
from tsas_cli.effects.free_tendon import FREE_TENDON, FreeTendon
from tsas_cli.effects.friction_drift import FRICTION_DRIFT, FrictionDrift
from tsas_cli.effects.laws.drive_law import DRIVE_LAW, DriveLaw
from tsas_cli.effects.laws.load_law import LOAD_LAW, LoadLaw
from tsas_cli.effects.laws.tendon_law import TENDON_LAW, TendonLaw
from tsas_cli.effects.load_damping import LOAD_DAMPING, LoadDamping
from tsas_cli.effects.load_dependent_friction import LOAD_DEPENDENT_FRICTION, LoadDependentFriction
from tsas_cli.effects.load_friction import LOAD_FRICTION, LoadFriction
from tsas_cli.effects.load_hysteresis import LOAD_HYSTERESIS, LoadHysteresis
from tsas_cli.effects.load_inertia import LOAD_INERTIA, LoadInertia
from tsas_cli.effects.load_relaxation import LOAD_RELAXATION, LoadRelaxation
from tsas_cli.effects.load_ripple import LOAD_RIPPLE
from tsas_cli.effects.load_spring_nonlinearity import (
    LOAD_SPRING_NONLINEARITY,
    LoadSpringNonlinearity,
)
from tsas_cli.effects.position_dependent_friction import (
    POSITION_DEPENDENT_FRICTION,
    PositionDependentFriction,
)
from tsas_cli.effects.position_sensor_gain import POSITION_SENSOR_GAIN, PositionSensorGain
from tsas_cli.effects.position_sensor_ripple import POSITION_SENSOR_RIPPLE
from tsas_cli.effects.preload_loss import PRELOAD_LOSS, PreloadLoss
from tsas_cli.effects.presliding import PRESLIDING, Presliding
from tsas_cli.effects.proximal_spring import PROXIMAL_SPRING, ProximalSpring
from tsas_cli.effects.pulley_friction import PULLEY_FRICTION, PulleyFriction
from tsas_cli.effects.sensor_lag import SENSOR_LAG, SensorLag
from tsas_cli.effects.sheath_compression import SHEATH_COMPRESSION, SheathCompression
from tsas_cli.effects.sheath_drag import SHEATH_DRAG, SheathDrag
from tsas_cli.effects.stribeck_friction import STRIBECK_FRICTION, StribeckFriction
from tsas_cli.effects.uneven_friction import UNEVEN_FRICTION, UnevenFriction
from tsas_cli.effects.viscous_friction import VISCOUS_FRICTION, ViscousFriction
from tsas_cli.numerics.wave import Wave

EFFECTS: tuple[Effect, ...] = (  # from the drive to the load, then the sensors
    BACKLASH,
    DRIVE_FRICTION,
    DRIVE_DAMPING,
    DRIVE_INERTIA,
    DRIVE_RIPPLE,
    DRIVE_COMPLIANCE,
    PROXIMAL_SPRING,
    FREE_TENDON,
    SHEATH_COMPRESSION,
    ANTAGONIST,
    DIRECTION_DEPENDENT_FRICTION,
    STRIBECK_FRICTION,
    VISCOUS_FRICTION,
    SHEATH_DRAG,
    LOAD_DEPENDENT_FRICTION,
    POSITION_DEPENDENT_FRICTION,
    UNEVEN_FRICTION,
    PULLEY_FRICTION,
    PRESLIDING,
    BEND_DRIFT,
    FRICTION_DRIFT,
    PRELOAD_LOSS,
    LOAD_SPRING_NONLINEARITY,
    LOAD_RIPPLE,
    LOAD_FRICTION,
    LOAD_INERTIA,
    LOAD_DAMPING,
    LOAD_HYSTERESIS,
    LOAD_RELAXATION,
    FORCE_SENSOR_GAIN,
    FORCE_SENSOR_OFFSET,
    FORCE_SENSOR_DRIFT,
    FORCE_SENSOR_GAIN_DRIFT,
    FORCE_SENSOR_CURVATURE,
    FORCE_SENSOR_HYSTERESIS,
    FORCE_SENSOR_TILT,
    FORCE_CROSSTALK,
    POSITION_SENSOR_GAIN,
    POSITION_SENSOR_RIPPLE,
    CHANNEL_DELAY,
    SENSOR_LAG,
)

LAWS: tuple[Effect, ...] = (
    DRIVE_LAW,
    TENDON_LAW,
    LOAD_LAW,
)  # of unnamed origin: they describe, not explain


class Effects(NamedTuple):
    """The values of the parameters of every effect and law, neutral by default."""

    backlash: Backlash = Backlash()
    drive_friction: DriveFriction = DriveFriction()
    drive_damping: DriveDamping = DriveDamping()
    drive_inertia: DriveInertia = DriveInertia()
    drive_ripple: Wave = Wave(period_mm=PERIOD_MM)
    drive_compliance: DriveCompliance = DriveCompliance()
    proximal_spring: ProximalSpring = ProximalSpring()
    free_tendon: FreeTendon = FreeTendon()
    sheath_compression: SheathCompression = SheathCompression()
    antagonist: Antagonist = Antagonist()
    direction_dependent_friction: DirectionDependentFriction = DirectionDependentFriction()
    stribeck_friction: StribeckFriction = StribeckFriction()
    viscous_friction: ViscousFriction = ViscousFriction()
    sheath_drag: SheathDrag = SheathDrag()
    load_dependent_friction: LoadDependentFriction = LoadDependentFriction()
    position_dependent_friction: PositionDependentFriction = PositionDependentFriction()
    uneven_friction: UnevenFriction = UnevenFriction()
    pulley_friction: PulleyFriction = PulleyFriction()
    presliding: Presliding = Presliding()
    bend_drift: BendDrift = BendDrift()
    friction_drift: FrictionDrift = FrictionDrift()
    preload_loss: PreloadLoss = PreloadLoss()
    load_spring_nonlinearity: LoadSpringNonlinearity = LoadSpringNonlinearity()
    load_ripple: Wave = Wave()
    load_friction: LoadFriction = LoadFriction()
    load_inertia: LoadInertia = LoadInertia()
    load_damping: LoadDamping = LoadDamping()
    load_hysteresis: LoadHysteresis = LoadHysteresis()
    load_relaxation: LoadRelaxation = LoadRelaxation()
    force_sensor_gain: ForceSensorGain = ForceSensorGain()
    force_sensor_offset: ForceSensorOffset = ForceSensorOffset()
    force_sensor_drift: ForceSensorDrift = ForceSensorDrift()
    force_sensor_gain_drift: ForceSensorGainDrift = ForceSensorGainDrift()
    force_sensor_curvature: ForceSensorCurvature = ForceSensorCurvature()
    force_sensor_hysteresis: ForceSensorHysteresis = ForceSensorHysteresis()
    force_sensor_tilt: ForceSensorTilt = ForceSensorTilt()
    force_crosstalk: ForceCrosstalk = ForceCrosstalk()
    position_sensor_gain: PositionSensorGain = PositionSensorGain()
    position_sensor_ripple: Wave = Wave()
    channel_delay: ChannelDelay = ChannelDelay()
    sensor_lag: SensorLag = SensorLag()
    drive_law: DriveLaw = DriveLaw()
    tendon_law: TendonLaw = TendonLaw()
    load_law: LoadLaw = LoadLaw()


__all__ = ["EFFECTS", "LAWS", "Effect", "Effects", "Parameter"]
