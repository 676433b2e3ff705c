import sys
from pathlib import Path

import pytest

from eyas.benchmark.flight.policy_runner import fly_batch
from eyas.benchmark.plan.plan import EvaluationPlan, batches

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def fly():
    """Flies a policy in four episodes; `fly("hover", latency="40")`."""

    def flown(policy, episodes=1, **changes):
        plan = EvaluationPlan(policy=policy, episodes=episodes, **changes)
        return [
            record for part in batches(plan) for ended in fly_batch(plan, part) for record in ended
        ]

    return flown
