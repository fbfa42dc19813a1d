//! NUCLEO-H743ZI2: STM32H743, revision V, at 480 MHz.
//!
//! - Clock: 8 MHz of the debugger on HSE, PLL1 at 960 MHz, core 480 MHz, buses 240 and 120 MHz, at the highest core voltage (VOS0).
//! - Memory: code and tables in flash behind both caches; stack, statics and the flight recorder in the data TCM, which is as quick as
//!   the core and needs no cache; DMA's buffers in SRAM1, which the MPU keeps out of the cache.
//! - Link: SPI1 at 48 MHz with DMA1: an exchange takes 54 µs of the 100. NSS PA4 (CN7 17), SCK PA5 (CN7 10), MISO PA6 (CN7 12), MOSI PB5
//!   (CN7 13 = D22).
//! - Timer: SysTick on the core's clock. Priorities: `SysTick` above everything, `PendSV` below.

use cortex_m::Peripherals as Core;
use saltus_loops::boards::Board;
use saltus_loops::frame::FRAME;
use saltus_loops::link::{Bus, Link};
use stm32h7::stm32h743v::{DMA1, Peripherals, SPI1};

use crate::exchange::Buffers;
use crate::{comes, silence, sleep};

/// Core clock, Hz.
const CORE_HZ: u32 = 480_000_000;
/// Requests of SPI1 at the DMA multiplexer: received, sent.
const REQUESTS: [u8; 2] = [37, 38];
/// All flags of DMA1's streams 0 and 1.
const STREAM_FLAGS: u32 = 0x3d | 0x3d << 6;

#[unsafe(link_section = ".sram1")]
static BUFFERS: Buffers = Buffers::new();

/// The board.
#[derive(Clone, Copy, Debug)]
pub struct NucleoH743;

impl Board<f64, 12> for NucleoH743 {
    const TIMER_HZ: u32 = CORE_HZ;

    type Robot = Link<Spi>;

    fn robot(core: &mut Core) -> Link<Spi> {
        // SAFETY: only this function touches the chip's registers until it hands some of them to the bus.
        let chip = unsafe { Peripherals::steal() };
        if !clocks(&chip) {
            <Self as Board<f64, 12>>::fault();
        }
        memories(core);
        pins(&chip);
        Link::new(Spi::new(chip.SPI1, chip.DMA1, &chip.DMAMUX1))
    }

    /// The flight recorder leaves with the frames.
    fn idle(_: impl FnMut(&mut [u8]) -> (usize, bool)) -> ! {
        sleep()
    }

    fn fault() -> ! {
        silence()
    }
}

/// 480 MHz, RM0433 sections 6.6 and 8.5; false if a clock or a voltage does not come.
fn clocks(chip: &Peripherals) -> bool {
    let (pwr, rcc, flash) = (&chip.PWR, &chip.RCC, &chip.FLASH);
    let voltage = || comes(|| pwr.d3cr().read().vosrdy().bit());
    // The internal regulator; then scale 1, and from there scale 0.
    pwr.cr3()
        .modify(|_, w| w.scuen().set_bit().ldoen().set_bit().bypass().clear_bit());
    let supplied = comes(|| pwr.csr1().read().actvosrdy().bit());
    // SAFETY: 3 is scale 1.
    pwr.d3cr().write(|w| unsafe { w.vos().bits(3) });
    let scale_1 = voltage();
    rcc.apb4enr().modify(|_, w| w.syscfgen().set_bit());
    chip.SYSCFG.pwrcr().modify(|_, w| w.oden().set_bit());
    let scale_0 = voltage();

    rcc.cr()
        .modify(|_, w| w.hsebyp().set_bit().hseon().set_bit());
    let reference = comes(|| rcc.cr().read().hserdy().bit());
    // 8 MHz / 1 · 120 = 960 MHz; / 2 for the core, / 10 for SPI1.
    rcc.pllckselr()
        .modify(|_, w| w.pllsrc().hse().divm1().set(1));
    rcc.pllcfgr().modify(|_, w| {
        let w = w.pll1vcosel().clear_bit().pll1fracen().clear_bit();
        let w = w.divp1en().set_bit().divq1en().set_bit();
        w.pll1rge().range8()
    });
    // SAFETY: factors less one, as above.
    rcc.pll1divr()
        .modify(|_, w| unsafe { w.divn1().bits(119).divp1().bits(1).divq1().bits(9) });
    rcc.cr().modify(|_, w| w.pll1on().set_bit());
    let locked = comes(|| rcc.cr().read().pll1rdy().bit());

    // Flash and buses for 240 MHz before the core is switched over.
    // SAFETY: four wait states, table 17 of RM0433.
    flash
        .acr()
        .modify(|_, w| unsafe { w.latency().bits(4).wrhighfreq().bits(2) });
    let waits = comes(|| flash.acr().read().latency().bits() == 4);
    rcc.d1cfgr()
        .modify(|_, w| w.d1cpre().div1().hpre().div2().d1ppre().div2());
    rcc.d2cfgr()
        .modify(|_, w| w.d2ppre1().div2().d2ppre2().div2());
    rcc.d3cfgr().modify(|_, w| w.d3ppre().div2());
    rcc.d2ccip1r().modify(|_, w| w.spi123sel().pll1_q());
    let ready = supplied && scale_1 && scale_0 && reference && locked && waits;
    if ready {
        rcc.cfgr().modify(|_, w| w.sw().pll1());
    }
    ready && comes(|| rcc.cfgr().read().sws().is_pll1())
}

/// SRAM1 for DMA, out of the cache; then both caches.
fn memories(core: &mut Core) {
    // Normal memory, not cached, shared, no code: 128 kB at SRAM1; everything else as by default.
    const BASE: u32 = 0x3000_0000;
    const ATTRIBUTES: u32 = 1 << 28 | 0b011 << 24 | 0b001 << 19 | 1 << 18 | 16 << 1 | 1;
    cortex_m::asm::dmb();
    // SAFETY: the region is used by the DMA's buffers only, and the default map stays for the rest.
    unsafe {
        core.MPU.rnr.write(0);
        core.MPU.rbar.write(BASE);
        core.MPU.rasr.write(ATTRIBUTES);
        core.MPU.ctrl.write(0b101);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
    core.SCB.enable_icache();
    core.SCB.enable_dcache(&mut core.CPUID);
}

/// Clocks of what is used, and SPI1's pins.
fn pins(chip: &Peripherals) {
    let rcc = &chip.RCC;
    rcc.ahb1enr().modify(|_, w| w.dma1en().set_bit());
    rcc.ahb2enr().modify(|_, w| w.sram1en().set_bit());
    rcc.ahb4enr()
        .modify(|_, w| w.gpioaen().set_bit().gpioben().set_bit());
    rcc.apb2enr().modify(|_, w| w.spi1en().set_bit());
    // A peripheral's clock is there two cycles after it was asked for.
    let _there = rcc.apb2enr().read().bits();
    let (a, b) = (&chip.GPIOA, &chip.GPIOB);
    a.afrl()
        .modify(|_, w| w.afr4().af5().afr5().af5().afr6().af5());
    a.ospeedr()
        .modify(|_, w| w.ospeedr4().very_high_speed().ospeedr5().very_high_speed());
    a.moder().modify(|_, w| {
        w.moder4()
            .alternate()
            .moder5()
            .alternate()
            .moder6()
            .alternate()
    });
    b.afrl().modify(|_, w| w.afr5().af5());
    b.ospeedr().modify(|_, w| w.ospeedr5().very_high_speed());
    b.moder().modify(|_, w| w.moder5().alternate());
}

/// SPI1 as master, with DMA1: stream 0 receives, stream 1 sends.
#[derive(Debug)]
pub struct Spi {
    spi: SPI1,
    dma: DMA1,
    under_way: bool,
    came: [u8; FRAME],
}

impl Spi {
    fn new(spi: SPI1, dma: DMA1, multiplexer: &stm32h7::stm32h743v::DMAMUX1) -> Self {
        for (channel, request) in REQUESTS.into_iter().enumerate() {
            // SAFETY: the numbers of SPI1's requests, table 121 of RM0433.
            multiplexer
                .ccr(channel)
                .write(|w| unsafe { w.dmareq_id().bits(request) });
        }
        let [data_in, data_out] = [spi.rxdr().as_ptr() as u32, spi.txdr().as_ptr() as u32];
        let [out, back] = BUFFERS.addresses();
        // SAFETY: SPI1's data registers, and buffers of a frame's length.
        unsafe {
            dma.st(0).par().write(|w| w.bits(data_in));
            dma.st(0).m0ar().write(|w| w.bits(back));
            dma.st(1).par().write(|w| w.bits(data_out));
            dma.st(1).m0ar().write(|w| w.bits(out));
        }
        // Bytes; half of the kernel's clock; the select line is the hardware's, low for the whole frame.
        spi.cfg1()
            .write(|w| w.dsize().set(7).fthlv().one_frame().mbr().div2());
        spi.cfg2().write(|w| {
            let w = w.master().set_bit().ssoe().set_bit().ssom().clear_bit();
            w.afcntr().set_bit()
        });
        spi.cr2().write(|w| w.tsize().set(FRAME as u16));
        Self {
            spi,
            dma,
            under_way: false,
            came: [0; FRAME],
        }
    }

    /// Everything off, flags cleared: as RM0433 wants it after a transfer, and before the next.
    fn stop(&mut self) {
        let (spi, dma) = (&self.spi, &self.dma);
        spi.cr1().modify(|_, w| w.spe().clear_bit());
        spi.cfg1()
            .modify(|_, w| w.rxdmaen().clear_bit().txdmaen().clear_bit());
        dma.st(0).cr().modify(|_, w| w.en().clear_bit());
        dma.st(1).cr().modify(|_, w| w.en().clear_bit());
        // SAFETY: writing ones clears flags.
        unsafe {
            spi.ifcr().write(|w| w.bits(0xff8));
            dma.lifcr().write(|w| w.bits(STREAM_FLAGS));
        }
        self.under_way = false;
    }
}

impl Bus for Spi {
    fn take(&mut self) -> Option<&[u8; FRAME]> {
        let sent = self.under_way && self.spi.sr().read().eot().bit();
        if !(sent && self.dma.lisr().read().tcif0().bit()) {
            return None;
        }
        self.stop();
        self.came = BUFFERS.back();
        Some(&self.came)
    }

    fn begin(&mut self, bytes: &[u8; FRAME]) -> bool {
        // What has not ended after a joint tick never will: it is dropped, and the link begins anew.
        let hung = self.under_way;
        self.stop();
        if hung {
            return false;
        }
        BUFFERS.fill(bytes);
        let (spi, dma) = (&self.spi, &self.dma);
        for stream in [0, 1] {
            dma.st(stream).ndtr().write(|w| w.ndt().set(FRAME as u16));
        }
        // In the order of RM0433, section 50.4.14.
        spi.cfg1().modify(|_, w| w.rxdmaen().set_bit());
        dma.st(0).cr().write(|w| {
            let w = w.dir().peripheral_to_memory().minc().set_bit();
            w.pl().very_high().en().set_bit()
        });
        dma.st(1).cr().write(|w| {
            let w = w.dir().memory_to_peripheral().minc().set_bit();
            w.pl().very_high().en().set_bit()
        });
        spi.cfg1().modify(|_, w| w.txdmaen().set_bit());
        spi.cr1().modify(|_, w| w.spe().set_bit());
        spi.cr1().modify(|_, w| w.cstart().set_bit());
        self.under_way = true;
        true
    }
}
