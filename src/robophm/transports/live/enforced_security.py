"""Secured DDS, where the environment asks for nothing else: only the rclpy of a sourced ROS 2 has it."""

from __future__ import annotations

import os

from robophm.core.errors import SourceError


def refuse_enforced_security(why: str = "DDS is spoken here without security") -> None:
    """Raise SourceError where the environment asks for secured DDS and nothing else; ``why`` that cannot be had."""
    enabled = os.environ.get("ROS_SECURITY_ENABLE", "").lower() == "true"
    if enabled and os.environ.get("ROS_SECURITY_STRATEGY", "").lower() == "enforce":
        raise SourceError(
            f"ROS_SECURITY_STRATEGY is Enforce, and {why}; expected the rclpy of a sourced ROS 2, which has it, or "
            "ROS_SECURITY_ENABLE=false"
        )
