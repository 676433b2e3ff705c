"""How people stand and walk: the skeletons of builds and postures, of a person of 1.80 m."""

from functools import cache

from art.jointed.figure import Figure, Gait, Joint, Leg, Swing
from art.jointed.people.person import (
    ANKLE,
    HEEL,
    HIP,
    NECK,
    SHANK,
    THIGH,
    TOES,
    UPPER_ARM,
    Build,
    Carried,
    Person,
    Posture,
)
from art.jointed.people.wardrobe import Dress

STRIDE = 1.46  # Of a person of 1.80 m [m]: 1.37 strides a second at the original's 2 m/s.

_SHOULDERS = {Build.MAN: 0.188, Build.WOMAN: 0.162, Build.STOUT: 0.198, Build.CHILD: 0.168}
"""y of the left shoulder [m]."""

_HIPS = {Build.MAN: 0.088, Build.WOMAN: 0.088, Build.STOUT: 0.098, Build.CHILD: 0.08}
"""y of the left hip [m]."""

_SHOULDER = 0.452  # Height of the shoulders above the hips [m]

_BEHIND = 0.51  # How far who pushes a pram is behind the middle of both [m]


def figure_of(
    person: Person,  # Who it is
    dress: Dress,  # The shapes of the parts
) -> Figure:
    """Return a person who walks."""
    stooped = person.posture is Posture.STOOPED
    behind = _BEHIND if person.carried is Carried.PRAM else 0.0
    return Figure(
        upright=True,
        scale=person.scale,
        joints=_joints(person, dress, stooped),
        legs=tuple(_leg(person.build, dress, side, behind) for side in (1.0, -1.0)),
        gait=_gait(0.8 if stooped else 1.0, behind),
    )


@cache
def _gait(share: float, behind: float) -> Gait:
    """Return a gait whose strides are a share of `STRIDE`; short ones lower the hips less.

    The trunk is `behind` the origin [m].
    """
    sinking = 1.0 if share == 1.0 else 0.5
    return Gait(
        stride=STRIDE * share,
        duty=0.6,
        lift=0.035,
        shift=-0.045,
        slowest=0.4,
        x=Swing(rest=-behind),
        y=Swing(size=0.015, phase=-0.04),
        # The body is lowest when both feet are on the ground.
        z=Swing(lean=-0.029 * sinking, size=0.03 * sinking, phase=-0.33, beats=2),
    )


def _joints(person: Person, dress: Dress, stooped: bool) -> tuple[Joint, ...]:
    lean = 0.16 if stooped else 0.0
    head = {Posture.PHONE: 0.42, Posture.STOOPED: -0.05, Posture.PUSHES: 0.15}
    nod = head.get(person.posture, 0.05)
    joints = [
        Joint(
            name="torso",
            shape=dress.chest,
            pivot=(0.0, 0.0, HIP),
            pitch=Swing(rest=lean, lean=0.03),
            yaw=Swing(size=0.07, phase=0.25),
        ),
        Joint(
            name="hips",
            shape=dress.hips,
            pivot=(0.0, 0.0, HIP),
            roll=Swing(size=0.03, phase=0.0),
            yaw=Swing(size=0.06, phase=0.75),
        ),
        Joint(
            name="head",
            shape=dress.head,
            parent="torso",
            pivot=(-0.01, 0.0, NECK),
            pitch=Swing(rest=nod - lean, lean=-0.02),
            yaw=Swing(size=0.06, phase=0.75),
            scale=person.build.head,
        ),
        Joint(name="hair", shape=dress.hair, parent="head", scale=person.build.head),
        *_arm(person, dress, 1.0),
        *_arm(person, dress, -1.0),
    ]
    if dress.carried is not None:
        joints.append(_held(person.carried, dress))
    return tuple(joints)


def _held(carried: Carried, dress: Dress) -> Joint:
    """Return the joint of what a person has along."""
    if carried is Carried.SHOPPING_BAG:
        return Joint(name="carried", shape=dress.carried, parent="right forearm")
    if carried is Carried.PRAM:
        return Joint(
            name="carried", shape=dress.carried, parent="ground", pivot=(0.82 - _BEHIND, 0.0, 0.0)
        )
    return Joint(name="carried", shape=dress.carried, parent="torso")


_ARMS = {
    Posture.FREE: ((0.04, 0.0, 0.36), (-0.22, -0.16, 0.18)),
    Posture.POCKETS: ((0.24, 0.0, 0.05), (-0.62, 0.0, 0.03)),
    Posture.PHONE: ((-0.3, 0.0, 0.03), (-1.55, 0.0, 0.02)),
    Posture.LADEN: ((0.02, 0.0, 0.1), (-0.05, 0.0, 0.02)),
    Posture.PUSHES: ((-0.42, 0.0, 0.02), (-0.75, 0.0, 0.02)),
}
"""Pitch of upper arm and forearm: `rest`, `lean` and `size` of its `Swing`. Whoever is not here has
free arms."""

_ONE_HANDED = (Posture.PHONE, Posture.LADEN)  # Postures of the right arm only


def _arm(person: Person, dress: Dress, side: float) -> tuple[Joint, Joint]:
    """Return upper arm and forearm of a side, 1 left, -1 right; they swing against the leg."""
    left = side > 0
    name = "left" if left else "right"
    phase = 0.25 if left else 0.75
    free = left and person.posture in _ONE_HANDED
    posture = Posture.FREE if free else person.posture
    upper, lower = _ARMS.get(posture, _ARMS[Posture.FREE])
    turned = 0.35 if posture is Posture.POCKETS else 0.1
    return (
        Joint(
            name=f"{name} arm",
            shape=dress.upper_arms[0 if left else 1],
            parent="torso",
            pivot=(-0.008, side * _SHOULDERS[person.build], _SHOULDER),
            roll=Swing(rest=0.13 * side),
            pitch=Swing(upper[0], upper[1], upper[2], phase),
        ),
        Joint(
            name=f"{name} forearm",
            shape=dress.forearms[0 if left else 1],
            parent=f"{name} arm",
            pivot=(0.0, 0.0, -UPPER_ARM),
            roll=Swing(rest=-turned * side),
            pitch=Swing(lower[0], lower[1], lower[2], phase),
        ),
    )


def _leg(build: Build, dress: Dress, side: float, behind: float) -> Leg:
    hip, at = _HIPS[build] * side, 0 if side > 0 else 1
    # One foot stands a little ahead of the other.
    return Leg(
        hip=(-0.008, hip, HIP),
        foot=(0.045 * side - behind, 0.85 * hip, ANKLE),
        bones=(THIGH, SHANK),
        knee=(1.0, 0.1 * side, 0.0),
        phase=0.0 if side > 0 else 0.5,
        shapes=(dress.thighs[at], dress.shanks[at], dress.shoe),
        sole=(HEEL, TOES),
        roll=(0.36, 0.75),
    )
