from eyas.engine.traffic.config import VehicleType
from eyas.engine.traffic.sumo import ActorSlots

CAR, BUS = VehicleType.PASSENGER, VehicleType.BUS


def cars(*numbers: int) -> dict[int, VehicleType]:
    return dict.fromkeys(numbers, CAR)


def test_vehicles_keep_their_actor():
    slots = ActorSlots([CAR] * 3)
    slots.advance(cars(7, 3))
    slots.advance(cars(3, 7, 9))
    assert slots.taken == {3: 0, 7: 1, 9: 2}


def test_an_actor_is_absent_a_step_before_it_is_another_vehicle():
    slots = ActorSlots([CAR] * 2)
    slots.advance(cars(0))
    slots.advance(cars(1))
    assert slots.taken == {1: 1}
    slots.advance(cars(1, 2))
    assert slots.taken == {1: 1, 2: 0}


def test_an_actor_never_changes_its_class():
    slots = ActorSlots([CAR, BUS, CAR])
    slots.advance({0: BUS, 1: CAR})
    slots.advance({2: CAR})
    assert slots.taken == {2: 2}
    slots.advance({2: CAR, 3: BUS})
    assert slots.taken == {2: 2, 3: 1}
