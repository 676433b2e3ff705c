from eyas.traffic.slots import Slots


def test_vehicles_keep_their_actor():
    slots = Slots(3)
    slots.advance([7, 3])
    slots.advance([3, 7, 9])
    assert slots.taken == {3: 0, 7: 1, 9: 2}


def test_an_actor_is_absent_a_step_before_it_is_another_vehicle():
    slots = Slots(2)
    slots.advance([0])
    slots.advance([1])
    assert slots.taken == {1: 1}
    slots.advance([1, 2])
    assert slots.taken == {1: 1, 2: 0}
