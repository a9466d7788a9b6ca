"""The oracle against numbers from the literature and from other solvers.

The known answers were found by bisecting the light-cone equation with 60 digits and are quoted with 32.
Their objects move with beta past an observer at rest in the scene frame, unless stated otherwise.
"""

import pytest
from mpmath import mp, mpf, sqrt

from oracle import Moment, Source, View, four_velocity, norm, rotation_matrix

QUOTED_DIGITS = mpf(10) ** -30


def passing(velocity, position=(0, 0, 0), time=0):
    """An observer at the scene's origin, and an object that moves past."""
    source = Source.of_object({"velocity": velocity, "position": list(position)})
    return View(Moment.of_scene({"observer": {"time": time}}), source)


def along_x(beta):
    return {"beta": mpf(beta), "direction": [1, 0, 0]}


def vector(*numbers):
    return [mpf(x) for x in numbers]


def agrees(found, expected):
    found, expected = (x if isinstance(x, list) else [x] for x in (found, expected))
    expected = [mpf(x) for x in expected]
    return norm([f - e for f, e in zip(found, expected, strict=True)]) <= QUOTED_DIGITS * norm(expected)


def test_a_point_beside_an_object_that_moves_along_an_axis():
    view = passing(along_x("0.9"))
    seen = view.seen_event(vector(1, 2, 3))
    assert agrees(seen[1:], ["-5.4313983388049515138295837447721", 2, 3])
    assert agrees(seen[0], "-6.5192091479544654100592021590645")
    assert agrees(view.doppler(vector(1, 2, 3)), "1.7423319331691484324362615291394")


def test_an_oblique_velocity():
    view = passing(vector("0.3", "-0.5", "0.6"))
    offset = vector("1.5", -2, 4)
    assert agrees(
        view.seen(offset),
        [
            "0.27887192972565097842337570482008",
            "0.035213450457248369294373825299875",
            "1.5577438594513019568467514096402",
        ],
    )
    assert agrees(view.doppler(offset), "0.33557433389690035039644029663942")


def test_a_normal():
    view = passing(vector("0.3", "-0.5", "0.6"))
    normal = [x / mpf(7) for x in (2, 3, 6)]
    assert agrees(
        view.normal(vector("1.5", -2, 4), normal),
        [
            "0.28518254028743249135148395669418",
            "0.11314618694899902502546717793713",
            "0.95177143216956722581322528399028",
        ],
    )


def test_an_observation_at_another_time_and_place():
    view = passing(along_x("0.8"), position=(-3, 2, 1), time=4)
    seen = view.seen_event(vector("0.5", "-0.5", "0.5"))
    assert agrees(seen[1:], ["-1.6499542958171873685715922011885", "1.5", "1.5"])
    # There, time is counted from scene time 0, here from the observation at time 4.
    assert agrees(seen[0] + 4, "1.3125571302285157892855097485144")


@pytest.mark.parametrize(
    ("x", "seen_x"),
    [
        (-1, "-6.9110599230888110886271336125101"),
        (0, "-4.1294832096701117863297724057617"),
        (1, "-2.3227452456775757704829420505526"),
    ],
)
def test_a_rod_beside_the_observer(x, seen_x):
    assert agrees(passing(along_x("0.9")).seen(vector(x, 2, 0)), [seen_x, 2, 0])


def test_an_edge_askew():
    along = [x / mpf(3) for x in (2, -1, 2)]
    point = [a + mpf("1.25") * o for a, o in zip((1, 2, -1), along, strict=True)]
    assert agrees(
        passing(vector("0.3", "-0.5", "0.6")).seen(point),
        [
            "0.38247752481924931102644601325746",
            "4.0014263475234733705114788667931",
            "-3.0683782836948347112804413068184",
        ],
    )


@pytest.mark.parametrize(
    ("corner", "seen_x"),
    [
        (("-0.5", 1, "0.5"), "-3.675860360623382537359829882341"),
        (("0.5", 1, "-0.5"), "-1.3817030219177648782877341013622"),
        (("0.5", 2, "0.5"), "-3.2328997011777797009048782752807"),
        (("-2.5", 2, "0.5"), "-12.425920821839297293565982553649"),
    ],
)
def test_corners_of_a_cube(corner, seen_x):
    assert agrees(passing(along_x("0.9")).seen(vector(*corner)), [seen_x, *corner[1:]])


@pytest.mark.parametrize(
    ("proper_time", "seen_x"),
    [(-6, "-114.74500319468068"), (0, "-9.1273047668899667"), (12, "5.4717847253442909")],
)
def test_time_steps_of_an_observer_who_moves(proper_time, seen_x):
    """The same flyby with the observer moving and the object at rest: the steps are proper times."""
    scene = {"observer": {"velocity": {"beta": mpf("0.95"), "direction": [-1, 0, 0]}}}
    at_rest = Source.of_object({"position": [0, 3, 0]})
    seen = View(Moment.of_scene(scene).after(proper_time), at_rest).seen(vector(0, 0, 0))
    assert abs(seen[0] - mpf(seen_x)) < mpf(10) ** -13  # quoted with 17 digits
    assert agrees(seen[1:], [3, 0])


@pytest.mark.parametrize(
    ("beta", "cosine", "doppler"),
    [
        ("0.5", 1, "0.57735026918962576450914878050196"),
        ("0.5", 0, "0.86602540378443864676372317075294"),
        ("0.5", -1, "1.7320508075688772935274463415059"),
        ("0.9", "0.5", "0.3006137202441843829128953092317"),
        ("0.9", "-0.5", "0.79252708064375882767945126979266"),
    ],
)
def test_doppler_factors_at_angles_seen(beta, cosine, doppler):
    """The angle is that at which the observer sees the point, so aberrate it first."""
    seen = mpf(cosine)
    at_rest = (seen + mpf(beta)) / (1 + mpf(beta) * seen)
    view = passing(along_x(beta))
    assert agrees(view.doppler([at_rest, sqrt(1 - at_rest**2), mpf(0)]), doppler)


def test_the_relative_velocity_of_two_that_move():
    """0.6 along x seen from 0.8 along y: gamma is 1.25 * 5/3 and no more."""
    observer = Moment.of_scene({"observer": {"velocity": vector(0, "0.8", 0)}})
    view = View(observer, Source.of_object({"velocity": vector("0.6", 0, 0)}))
    assert agrees(view.relative_gamma(), mpf(25) / 12)


def test_the_ways_to_write_a_speed_agree():
    direction = [1, -2, 2]
    ways = [
        {"beta": mpf("0.6")},
        {"one_minus_beta": mpf("0.4")},
        {"gamma": mpf("1.25")},
        {"rapidity": mp.atanh(mpf("0.6"))},
    ]
    as_vector = four_velocity([mpf("0.6") * x / 3 for x in direction])
    for way in ways:
        assert agrees(four_velocity({**way, "direction": direction}), as_vector)


def test_axes_turned_by_a_quarter():
    """About z: what was seen along y is then seen along x."""
    half = sqrt(mpf(1) / 2)
    moment = Moment.of_scene({"observer": {"velocity": {"beta": mpf("0.6"), "direction": [1, 2, -2]}}})
    source = Source.of_object({"velocity": along_x("0.8"), "position": [0, 3, 1]})
    x, y, z = View(moment, source).seen(vector(1, 2, 3))
    turned = moment.turned([0, 0, half, half])
    assert agrees(View(turned, source).seen(vector(1, 2, 3)), [y, -x, z])
    twice = turned.turned([0, 0, half, half])
    assert agrees(View(twice, source).seen(vector(1, 2, 3)), [-x, -y, z])
    there = turned.scene_to_observer()
    back = [[sum(a * b for a, b in zip(row, c, strict=True)) for c in zip(*there, strict=True)]
            for row in turned.observer_to_scene()]
    assert all(abs(back[i][j] - (i == j)) < QUOTED_DIGITS for i in range(4) for j in range(4))


def test_a_quarter_turn():
    half = sqrt(mpf(1) / 2)
    turned = Source([], [], rotation_matrix([0, 0, half, half]), [1, 1, 1]).placed([1, 2, 3])
    assert agrees(turned, [-2, 1, 3])
