#![no_std]
//! Rigid-body dynamics.
