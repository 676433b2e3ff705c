"""Policies, protocols and figures: the same episodes for all, with their uncertainty.

May import: `envs` and all rooms below.
Begin with `plan.py`; a policy: `policies/policy.py`. Private: `eyas` offers what is public.
"""
