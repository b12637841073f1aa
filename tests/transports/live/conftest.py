from ..ros2_dds.conftest import domain

__all__ = ["domain"]
