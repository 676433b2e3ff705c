import json
import math

from eyas.engine.exports.label import rounded, rounded_list


def test_numbers_have_fixed_decimals_and_no_negative_zero():
    assert rounded(1.23456749) == 1.234567
    assert json.dumps(rounded(-1e-9)) == "0.0"
    assert rounded_list([math.nan, math.inf, 2]) == [None, None, 2.0]
