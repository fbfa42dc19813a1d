//! Raspberry Pi Pico 2: RP2350, its first Cortex-M33 at 150 MHz, in single precision.
//!
//! - Clock: 12 MHz crystal, system PLL at 1500 MHz, by 10; the same for SPI.
//! - Memory: 256 of the 520 kB of SRAM, striped over its banks, hold stack, statics, flight recorder and DMA's buffers: nothing is cached.
//!   Code runs from flash behind the 16 kB of its cache, at the speed that the boot ROM has left.
//! - Link: SPI0 at 37.5 MHz with DMA: an exchange takes 71 µs of the 100. RX GP16, CS GP17 (driven here: the hardware's would rise
//!   between bytes), SCK GP18, TX GP19.
//! - Timer: SysTick on the core's clock. Priorities: `SysTick` above everything, `PendSV` below.

use cortex_m::Peripherals as Core;
use rp235x_pac::{DMA, Peripherals, SIO, SPI0};
use saltus_loops::boards::Board;
use saltus_loops::frame::FRAME;
use saltus_loops::link::{Bus, Link};

use crate::exchange::Buffers;
use crate::{comes, silence, sleep};

/// Core clock, Hz.
const CORE_HZ: u32 = 150_000_000;
/// Bytes that the SPI itself holds.
const FIFO: usize = 8;
const RX: usize = 16;
const CS: usize = 17;
const SCK: usize = 18;
const TX: usize = 19;

static BUFFERS: Buffers = Buffers::new();

/// What the boot ROM looks for: an image for Arm, secure, datasheet section 5.9.5.
#[unsafe(link_section = ".start_block")]
#[used]
static IMAGE: [u32; 5] = [
    0xffff_ded3,
    0x1021_0142,
    0x0000_01ff,
    0x0000_0000,
    0xab12_3579,
];

/// The board.
#[derive(Clone, Copy, Debug)]
pub struct Pico2;

impl Board<f32, 12> for Pico2 {
    const TIMER_HZ: u32 = CORE_HZ;

    type Robot = Link<Spi>;

    fn robot(_: &mut Core) -> Link<Spi> {
        // SAFETY: only this function touches the chip's registers until it hands some of them to the bus.
        let chip = unsafe { Peripherals::steal() };
        if !(clocks(&chip) && pins(&chip)) {
            <Self as Board<f32, 12>>::fault();
        }
        Link::new(Spi::new(chip.SPI0, chip.DMA, chip.SIO))
    }

    /// The flight recorder leaves with the frames.
    fn idle(_: impl FnMut(&mut [u8]) -> (usize, bool)) -> ! {
        sleep()
    }

    fn fault() -> ! {
        silence()
    }
}

/// 150 MHz; false if crystal or PLL do not come.
fn clocks(chip: &Peripherals) -> bool {
    let (xosc, clocks, pll) = (&chip.XOSC, &chip.CLOCKS, &chip.PLL_SYS);
    // A millisecond for the crystal: 47 · 256 cycles of it.
    // SAFETY: a delay of 14 bits.
    xosc.startup().write(|w| unsafe { w.delay().bits(47) });
    xosc.ctrl()
        .write(|w| w.freq_range()._1_15mhz().enable().enable());
    let crystal = comes(|| xosc.status().read().stable().bit());
    clocks.clk_ref_ctrl().modify(|_, w| w.src().xosc_clksrc());
    let reference = comes(|| clocks.clk_ref_selected().read().bits() == 1 << 2);
    // The core leaves the PLL before that is touched.
    clocks.clk_sys_ctrl().modify(|_, w| w.src().clk_ref());
    let slow = comes(|| clocks.clk_sys_selected().read().bits() == 1);
    let there = unreset(chip, |r| r.pll_sys().bit(), |w| w.pll_sys().clear_bit());
    // 12 MHz / 1 · 125 = 1500 MHz, / 5 / 2.
    // SAFETY: factors inside the PLL's ranges, datasheet section 8.6.
    unsafe {
        pll.cs().modify(|_, w| w.refdiv().bits(1));
        pll.fbdiv_int().write(|w| w.fbdiv_int().bits(125));
    }
    pll.pwr()
        .modify(|_, w| w.pd().clear_bit().vcopd().clear_bit());
    let locked = comes(|| pll.cs().read().lock().bit());
    // SAFETY: as above.
    pll.prim()
        .write(|w| unsafe { w.postdiv1().bits(5).postdiv2().bits(2) });
    pll.pwr().modify(|_, w| w.postdivpd().clear_bit());
    let ready = crystal && reference && slow && there && locked;
    if ready {
        clocks
            .clk_sys_ctrl()
            .modify(|_, w| w.auxsrc().clksrc_pll_sys());
        clocks
            .clk_sys_ctrl()
            .modify(|_, w| w.src().clksrc_clk_sys_aux());
        clocks
            .clk_peri_ctrl()
            .write(|w| w.auxsrc().clk_sys().enable().set_bit());
    }
    ready && comes(|| clocks.clk_sys_selected().read().bits() == 1 << 1)
}

/// Takes a block out of reset.
fn unreset(
    chip: &Peripherals,
    done: impl Fn(&rp235x_pac::resets::reset_done::R) -> bool,
    clear: impl FnOnce(&mut rp235x_pac::resets::reset::W) -> &mut rp235x_pac::resets::reset::W,
) -> bool {
    chip.RESETS.reset().modify(|_, w| clear(w));
    comes(|| done(&chip.RESETS.reset_done().read()))
}

/// Blocks that are used, and SPI0's pins.
fn pins(chip: &Peripherals) -> bool {
    let there = unreset(
        chip,
        |r| r.io_bank0().bit() && r.pads_bank0().bit() && r.spi0().bit() && r.dma().bit(),
        |w| {
            let w = w.io_bank0().clear_bit().pads_bank0().clear_bit();
            w.spi0().clear_bit().dma().clear_bit()
        },
    );
    if !there {
        return false;
    }
    for pin in [RX, CS, SCK, TX] {
        let function = &chip.IO_BANK0.gpio(pin).gpio_ctrl();
        if pin == CS {
            // SAFETY: a bit of a pin that is ours.
            unsafe {
                chip.SIO.gpio_out_set().write(|w| w.bits(1 << CS));
                chip.SIO.gpio_oe_set().write(|w| w.bits(1 << CS));
            }
            function.write(|w| w.funcsel().sio());
        } else {
            function.write(|w| w.funcsel().spi());
        }
        // Input on, output not off, and no longer isolated: in this order nothing glitches.
        chip.PADS_BANK0.gpio(pin).modify(|_, w| {
            let w = w.ie().set_bit().od().clear_bit();
            w.slewfast().set_bit().iso().clear_bit()
        });
    }
    true
}

/// SPI0 as master, with DMA: channel 0 receives, channel 1 sends.
pub struct Spi {
    spi: SPI0,
    dma: DMA,
    sio: SIO,
    under_way: bool,
    came: [u8; FRAME],
}

impl core::fmt::Debug for Spi {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Spi")
    }
}

impl Spi {
    fn new(spi: SPI0, dma: DMA, sio: SIO) -> Self {
        // Bytes, mode 0, 150 / 4 MHz.
        // SAFETY: values of the PL022's registers, datasheet section 12.3.5.
        unsafe {
            spi.sspcpsr().write(|w| w.cpsdvsr().bits(4));
            spi.sspcr0().write(|w| w.dss().bits(7).scr().bits(0));
        }
        spi.sspdmacr()
            .write(|w| w.rxdmae().set_bit().txdmae().set_bit());
        spi.sspcr1().write(|w| w.sse().set_bit());
        Self {
            spi,
            dma,
            sio,
            under_way: false,
            came: [0; FRAME],
        }
    }

    /// The select line up.
    fn stop(&mut self) {
        // SAFETY: a bit of a pin that is ours.
        self.sio
            .gpio_out_set()
            .write(|w| unsafe { w.bits(1 << CS) });
        self.under_way = false;
    }
}

impl Bus for Spi {
    fn take(&mut self) -> Option<&[u8; FRAME]> {
        let busy = self.dma.ch(0).ch_ctrl_trig().read().busy().bit();
        if busy || !self.under_way {
            return None;
        }
        self.stop();
        self.came = BUFFERS.back();
        Some(&self.came)
    }

    fn begin(&mut self, bytes: &[u8; FRAME]) -> bool {
        if self.under_way {
            // What has not ended after a joint tick never will: it is dropped, and the link begins anew.
            // SAFETY: stops channels 0 and 1.
            self.dma.chan_abort().write(|w| unsafe { w.bits(0b11) });
            for _ in 0..FIFO {
                let _late = self.spi.sspdr().read().bits();
            }
            self.stop();
            return false;
        }
        BUFFERS.fill(bytes);
        let [out, back] = BUFFERS.addresses();
        let data = self.spi.sspdr().as_ptr() as u32;
        // SAFETY: a pin that is ours; SPI0's data register and buffers of a frame's length; each channel chains to itself, so to none.
        unsafe {
            self.sio.gpio_out_clr().write(|w| w.bits(1 << CS));
            for (channel, from, to) in [(0, data, back), (1, out, data)] {
                let it = self.dma.ch(channel);
                it.ch_read_addr().write(|w| w.bits(from));
                it.ch_write_addr().write(|w| w.bits(to));
                it.ch_trans_count().write(|w| w.bits(FRAME as u32));
                it.ch_ctrl_trig().write(|w| {
                    let w = w.data_size().size_byte().chain_to().bits(channel as u8);
                    let w = if channel == 0 {
                        w.incr_write().set_bit().treq_sel().spi0_rx()
                    } else {
                        w.incr_read().set_bit().treq_sel().spi0_tx()
                    };
                    w.en().set_bit()
                });
            }
        }
        self.under_way = true;
        true
    }
}
