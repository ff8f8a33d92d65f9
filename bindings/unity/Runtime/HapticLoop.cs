using System;
using System.Diagnostics;
using System.Threading;

namespace Palpate
{
    /// <summary>The loop's time. Tests replace it.</summary>
    public class LoopClock
    {
        public virtual long Frequency { get { return Stopwatch.Frequency; } }

        public virtual long Now { get { return Stopwatch.GetTimestamp(); } }

        /// <summary>Waits until Now is at least `due`. In the last 2 ms it yields and polls, because Sleep() is too
        /// coarse for 1 kHz; the loop thus keeps one processor core busy.</summary>
        public virtual void WaitUntil(long due)
        {
            for (;;)
            {
                long left = due - Now;
                if (left <= 0) return;
                Thread.Sleep(left > Frequency / 500 ? 1 : 0);
            }
        }
    }

    /// <summary>
    /// Runs the ticks of a simulation on its own thread at Info.Rate. Each tick reads every device, computes the
    /// forces, and writes them to the devices.
    ///
    /// A loop with a held device has a watchdog: when no tick begins for 20 ms, it calls Stop() of every device, and
    /// the next tick passes Fault.StalledLoop for every hand. A pause of all managed threads (garbage collection, a
    /// debugger) pauses the watchdog, too, so a device that can hurt needs a watchdog in its own driver.
    /// </summary>
    public sealed class HapticLoop : IDisposable
    {
        /// <summary>s without a tick that count as a stall.</summary>
        public const double StallLimit = 0.02;

        private const int Fresh = 4; // bit of `middle`: not read yet

        private readonly Simulation simulation;
        private readonly IHapticDevice[] devices;
        private readonly LoopClock clock;
        private readonly bool watched;
        private readonly long stallTicks;
        private readonly ulong lastTick;
        private readonly Sample[] samples;
        private readonly Result[] results;
        private readonly bool[] muted; // until the gate's force is zero after a stall
        private readonly bool[] refused; // the last command
        private readonly Result[][] published = new Result[3][]; // a triple buffer
        private int writing, middle = 1, reading = 2;
        private Thread loop, watchdog;
        private long beat; // start of the newest tick
        private int stopped; // 1: by the watchdog, since the newest tick
        private int watchdogStops, stalls;
        private volatile bool ending;
        private volatile bool running;
        private volatile Exception failure;

        /// <param name="simulation">must stay open until Dispose()</param>
        /// <param name="devices">one per hand</param>
        /// <param name="ticks">number of ticks to run; 0: until Dispose()</param>
        /// <param name="clock">null: a Stopwatch</param>
        public HapticLoop(Simulation simulation, IHapticDevice[] devices, ulong ticks = 0, LoopClock clock = null)
        {
            if (devices == null || devices.Length != simulation.Hands || Array.IndexOf(devices, null) >= 0)
            {
                throw new PalpateException(ErrorKind.Use, "HapticLoop: needs one device per hand");
            }
            this.simulation = simulation;
            this.devices = (IHapticDevice[])devices.Clone();
            this.clock = clock ?? new LoopClock();
            watched = simulation.Info.Held != 0;
            stallTicks = (long)(StallLimit * this.clock.Frequency);
            lastTick = ticks;
            samples = new Sample[devices.Length];
            results = new Result[devices.Length];
            muted = new bool[devices.Length];
            refused = new bool[devices.Length];
            for (int i = 0; i < published.Length; ++i) published[i] = new Result[devices.Length];
        }

        /// <summary>Whether the loop's thread ticks.</summary>
        public bool Running { get { return running; } }

        /// <summary>The exception of a device that ended the loop; null: none.</summary>
        public Exception Failure { get { return failure; } }

        /// <summary>Number of stalls of 20 ms or more.</summary>
        public int Stalls { get { return Volatile.Read(ref stalls); } }

        /// <summary>How often the watchdog stopped the devices.</summary>
        public int WatchdogStops { get { return Volatile.Read(ref watchdogStops); } }

        /// <summary>Starts the threads. Once per object.</summary>
        public void Start()
        {
            if (loop != null) throw new PalpateException(ErrorKind.Use, "HapticLoop.Start: it was started already");
            Volatile.Write(ref beat, clock.Now);
            running = true;
            loop = new Thread(Run) { IsBackground = true, Name = "Palpate haptics", Priority = ThreadPriority.Highest };
            loop.Start();
            if (!watched) return;
            watchdog = new Thread(Watch)
            {
                IsBackground = true, Name = "Palpate watchdog", Priority = ThreadPriority.Highest
            };
            watchdog.Start();
        }

        /// <summary>Waits until the given number of ticks has run, or a device has failed.</summary>
        public bool Wait(int milliseconds)
        {
            return loop == null || loop.Join(milliseconds);
        }

        /// <summary>Ends the loop and stops the devices. Waits for a device that is stuck.</summary>
        public void Dispose()
        {
            ending = true;
            if (loop != null) loop.Join();
            if (watchdog != null) watchdog.Join();
        }

        /// <summary>Copies the newest results; for one thread, such as that of the picture.</summary>
        /// <param name="newest">one per hand; unchanged before the first tick</param>
        public void CopyResults(Result[] newest)
        {
            if ((Volatile.Read(ref middle) & Fresh) != 0) reading = Interlocked.Exchange(ref middle, reading) & ~Fresh;
            Array.Copy(published[reading], newest, newest.Length);
        }

        private void Run()
        {
            try
            {
                double period = clock.Frequency / simulation.Info.Rate;
                long first = clock.Now; // when tick `from` was due
                ulong from = 0;
                for (ulong tick = 0; !ending && (lastTick == 0 || tick < lastTick); ++tick)
                {
                    clock.WaitUntil(first + (long)((tick - from) * period));
                    long now = clock.Now;
                    bool late = now - Volatile.Read(ref beat) >= stallTicks;
                    Volatile.Write(ref beat, now);
                    late |= Interlocked.Exchange(ref stopped, 0) != 0;
                    if (late)
                    {
                        Interlocked.Increment(ref stalls);
                        first = now; // the missed ticks are left out
                        from = tick;
                    }
                    Tick(tick, late && watched);
                }
            }
            catch (Exception error)
            {
                failure = error;
            }
            finally
            {
                ending = true;
                StopDevices();
                running = false;
            }
        }

        private void Tick(ulong tick, bool stalled)
        {
            double time = tick / simulation.Info.Rate;
            for (int hand = 0; hand < devices.Length; ++hand)
            {
                samples[hand].Fault = Fault.None;
                devices[hand].Read(tick, time, ref samples[hand]);
                if (refused[hand]) samples[hand].Fault = Fault.Device;
                if (!stalled) continue;
                samples[hand].Fault = Fault.StalledLoop;
                muted[hand] = true;
            }
            simulation.Tick(samples, results);
            for (int hand = 0; hand < devices.Length; ++hand) Write(hand);
            Array.Copy(results, published[writing], results.Length);
            writing = Interlocked.Exchange(ref middle, writing | Fresh) & ~Fresh;
        }

        private void Write(int hand)
        {
            if (muted[hand])
            {
                muted[hand] = results[hand].DeviceForce.Length + results[hand].DeviceTorque.Length +
                              Math.Abs(results[hand].GripperForce) != 0.0;
                if (muted[hand])
                {
                    devices[hand].Stop();
                    return;
                }
            }
            if (Volatile.Read(ref stopped) != 0) return; // the next tick passes the fault
            refused[hand] = !devices[hand].Write(ref results[hand]);
        }

        private void Watch()
        {
            while (!ending)
            {
                Thread.Sleep(5);
                if (clock.Now - Volatile.Read(ref beat) < stallTicks || Volatile.Read(ref stopped) != 0) continue;
                Volatile.Write(ref stopped, 1);
                Interlocked.Increment(ref watchdogStops);
                StopDevices();
            }
        }

        private void StopDevices()
        {
            foreach (IHapticDevice device in devices)
            {
                try
                {
                    device.Stop();
                }
                catch (Exception error)
                {
                    failure = failure ?? error;
                }
            }
        }
    }
}
