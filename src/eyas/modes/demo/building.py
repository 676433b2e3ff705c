"""Builds another world in a thread of its own, while the present one is flown and shown."""

from concurrent.futures import Future, ThreadPoolExecutor

from eyas.core.errors import EyasError
from eyas.modes.demo.choices import Plan
from eyas.modes.demo.flight import Flight

__all__ = ["Builder"]


class Builder:
    """Builds one world at a time; of those that are ordered meanwhile, only the last.

    Attributes:
        plan: What is being built, or was last; choices that follow start from it.
        flown: What was built last.

    Args:
        plan: The world that there is.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = self.flown = plan
        self._threads = ThreadPoolExecutor(1, "eyas-world")
        self._built: Future[Flight] | None = None
        self._building = plan

    @property
    def busy(self) -> bool:
        """Whether a world is being built."""
        return self._built is not None

    def order(self, plan: Plan) -> None:
        """Begin to build a world, or do so when the one before is built."""
        self.plan = plan
        if self._built is None:
            self._begin()

    def _begin(self) -> None:
        self._building = self.plan
        self._built = self._threads.submit(self.plan.build)

    def take(self) -> Flight | None:
        """Return the flight in the world that was ordered last, once, when it is built.

        Raises:
            EyasError: It cannot be built.
        """
        if self._built is None or not self._built.done():
            return None
        built, self._built = self._built, None
        if self._building is not self.plan:
            self._begin()
            return None
        try:
            flight = built.result()
        except EyasError:
            self.plan = self.flown
            raise
        self.flown = self.plan
        return flight

    def stop(self) -> None:
        """Wait for a world that is being built, and drop it."""
        self._threads.shutdown(cancel_futures=True)
