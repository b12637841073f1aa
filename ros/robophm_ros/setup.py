# For catkin alone: it asks this file where the Python package is.
from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["robophm_ros"], package_dir={"": "src"}))
